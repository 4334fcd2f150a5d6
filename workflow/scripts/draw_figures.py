"""Draw Figures 1 to 4 of the paper from our runs."""

from jointwear.publishing.figures.paper import draw_paper_figures
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw_paper_figures(
            simulation=snakemake.input.simulation,
            features=snakemake.input.features,
            model=snakemake.input.model,
            detection=snakemake.input.detection,
            trajectories=snakemake.input.trajectories,
            robot=snakemake.input.robot,
            task=snakemake.input.task,
            published=snakemake.input.published,
            outputs=dict(snakemake.output.items()),
            replicate=snakemake.params.replicate,
            confidence=snakemake.params.confidence,
        )
