"""Draw the figure of the side-by-side view."""

from jointwear.running.script import reported
from jointwear.studies.side_by_side.figures import draw_hours

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_hours(snakemake.input.chapter, snakemake.output[0])
