"""Draw Figure 3: Q residuals."""

from jointwear.publishing.figures.figure_3 import draw_figure_3
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_figure_3(
            snakemake.input.model,
            snakemake.input.detection,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.replicate,
            snakemake.params.confidence,
        )
