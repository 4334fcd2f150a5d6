"""Draw the figure of the test of the verdict."""

from jointwear.running.script import reported
from jointwear.studies.recovery.validation_figure import draw_validation

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_validation(snakemake.input.chapter, snakemake.output[0])
