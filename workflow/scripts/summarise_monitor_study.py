"""Assemble the results of the monitor's study for the report."""

from jointwear.running.script import reported
from jointwear.studies.monitor_study.summary import write_chapter

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        tasks, scenarios = snakemake.params.tasks, snakemake.params.scenarios
        write_chapter(
            dict(zip(tasks, snakemake.input.grid, strict=True)),
            dict(zip(tasks, snakemake.input.peers, strict=True)),
            dict(zip(scenarios, snakemake.input.factory, strict=True)),
            dict(zip(scenarios, snakemake.input.decisions, strict=True)),
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.seed,
        )
