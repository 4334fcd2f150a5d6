"""Bound the torque of the unloaded arm, whatever its poses."""

from jointwear.running.script import reported
from jointwear.studies.recovery.bound import bound_published

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        bound_published(
            snakemake.input.robot, snakemake.input.published, snakemake.output[0], snakemake.params.settings
        )
