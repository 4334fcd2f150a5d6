"""Simulate one worn run, all replicates."""

from jointwear.reproduction.grid import Cell
from jointwear.reproduction.worn_run import simulate_worn_run
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        cell = snakemake.wildcards
        simulate_worn_run(
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.output[0],
            cell=Cell(cell.task, float(cell.increase), int(cell.axis)),
            settings=snakemake.params.settings,
        )
