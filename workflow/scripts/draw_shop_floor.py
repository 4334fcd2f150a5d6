"""Draw one figure of the shop floor."""

from jointwear.running.script import reported
from jointwear.studies.shop_floor.figures import DRAWINGS

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        DRAWINGS[snakemake.wildcards.drawing](snakemake.input.chapter, snakemake.output[0])
