"""Simulate one worn run, all replicates."""

from jointwear.reproduction.grid import cell_of
from jointwear.reproduction.simulation import simulate_worn_run
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        simulate_worn_run(
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.output[0],
            cell=cell_of(snakemake.output[0]),
            settings=snakemake.params.settings,
        )
