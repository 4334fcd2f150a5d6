"""Draw one figure of the recovery."""

from jointwear.running.script import reported
from jointwear.studies.recovery.figures import draw

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw(snakemake.wildcards.recovery_picture, snakemake.input.chapter, snakemake.output[0])
