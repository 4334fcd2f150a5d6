"""Summarise the normal operation of a task."""

from jointwear.reproduction.features import write_reference
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_reference(snakemake.input.torque, snakemake.output[0], snakemake.params.settings)
