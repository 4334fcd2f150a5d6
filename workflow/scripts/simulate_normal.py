"""Simulate normal operation that the detector has not seen."""

from jointwear.reproduction.simulation import simulate_run
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        simulate_run(
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.output[0],
            key=("normal", snakemake.wildcards.task),
            hours=snakemake.params.hours,
            settings=snakemake.params.settings,
        )
