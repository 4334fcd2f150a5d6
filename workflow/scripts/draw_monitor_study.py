"""Draw one figure of the monitor's study."""

from jointwear.monitor_study.figures import DRAWINGS
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        DRAWINGS[snakemake.wildcards.drawing](snakemake.input.chapter, snakemake.output[0])
