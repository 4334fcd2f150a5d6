"""Judge runs of the paper's grid as a user's robots are judged."""

from jointwear.running.script import reported
from jointwear.studies.monitor_study.grid_judgement import judge_grid

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        judge_grid(
            snakemake.input.robot, snakemake.input.task, snakemake.input.runs, snakemake.output[0],
            snakemake.params.settings,
        )  # fmt: skip
