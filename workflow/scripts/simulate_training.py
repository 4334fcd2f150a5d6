"""Simulate the normal operation from which the detector learns."""

from jointwear.reproduction.readings import select, training_length
from jointwear.reproduction.simulation import simulate_run
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        simulate_run(
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.output[0],
            key=("training", snakemake.wildcards.task),
            hours=select(training_length, snakemake.params.length)(),
            settings=snakemake.params.settings,
        )
