"""Build the report of the reproduction."""

from jointwear.publishing.report.assembly import Results
from jointwear.publishing.report.page import write_report
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        found, tasks = snakemake.input, snakemake.params.config["tasks"]
        by_task = {
            name: dict(zip(tasks, found[name], strict=True))
            for name in (
                "models",
                "tasks",
                "training_features",
                "training_simulations",
                "normal_simulations",
                "normal_detections",
                "normal_locations",
            )
        }
        write_report(
            snakemake.output.page,
            snakemake.output.scores,
            Results(
                published=found.published,
                robot=found.robot,
                tables=dict(zip(snakemake.params.tables, found.tables, strict=True)),
                simulations=list(found.simulations),
                detections=list(found.detections),
                locations=list(found.locations),
                figure_run=dict(zip(snakemake.params.figure_run, found.figure_run, strict=True)),
                **by_task,
            ),
            dict(zip(snakemake.params.figures, [*found.figures, *found.chapter_figures], strict=True)),
            snakemake.params.config,
            chapters=dict(zip(snakemake.params.chapters, found.chapters, strict=True)),
        )
