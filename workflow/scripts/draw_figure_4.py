"""Draw Figure 4: paths of the end effector."""

from jointwear.publishing.figures.figure_4 import draw_figure_4
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_figure_4(snakemake.input.trajectories, snakemake.input.published, snakemake.output[0])
