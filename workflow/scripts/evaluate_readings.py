"""Run one part of the readings on the configured pose set."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.reading_stages import evaluate_readings

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        evaluate_readings(
            snakemake.input.design,
            snakemake.input.robot,
            snakemake.input.tasks,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.part,
            snakemake.params.settings,
        )
