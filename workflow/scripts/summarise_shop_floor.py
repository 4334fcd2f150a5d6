"""Assemble the results of the shop floor for the report."""

from jointwear.running.script import reported
from jointwear.studies.shop_floor.stages import summarise

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        grid = dict(zip(snakemake.params.tasks, snakemake.input.grid, strict=True))
        summarise(snakemake.input.outcomes, snakemake.input.before, grid, snakemake.output[0])
