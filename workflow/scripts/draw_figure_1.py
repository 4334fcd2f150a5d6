"""Draw Figure 1: friction torque under wear."""

from jointwear.publishing.figures.figure_1 import draw_figure_1
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_figure_1(
            snakemake.input.simulation,
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.replicate,
        )
