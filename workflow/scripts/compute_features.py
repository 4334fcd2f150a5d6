"""Compute the hourly features of a run."""

from jointwear.reproduction.features import write_features
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_features(
            snakemake.input.torque, snakemake.input.reference, snakemake.output[0], snakemake.params.settings
        )
