"""Fit the principal component model of a task's normal operation."""

from jointwear.reproduction.normal_model import write_normal_model
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_normal_model(snakemake.input.features, snakemake.output[0], snakemake.params.settings)
