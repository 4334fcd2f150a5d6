"""Draw one figure of the recovery."""

from jointwear.recovery.figures import draw
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw(snakemake.wildcards.recovery_picture, snakemake.input.chapter, snakemake.output[0])
