"""Measure the monitor on all runs of one task."""

from jointwear.running.script import reported
from jointwear.studies.monitor_study.grid_study import study_task

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        study_task(
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.input.runs,
            snakemake.input.detection,
            snakemake.input.location,
            snakemake.output[0],
            snakemake.params.settings,
        )
