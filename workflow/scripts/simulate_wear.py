"""Simulate one worn run, all replicates."""

from jointwear.grid import cell_of
from jointwear.script import reported
from jointwear.simulation import simulate_worn_run

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        simulate_worn_run(
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.output[0],
            cell=cell_of(snakemake.output[0]),
            settings=snakemake.params.settings,
        )
