"""Draw Figure 2: KL divergence of all axes."""

from jointwear.publishing.figures.figure_2 import draw_figure_2
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_figure_2(
            snakemake.input.features, snakemake.input.published, snakemake.output[0], snakemake.params.replicate
        )
