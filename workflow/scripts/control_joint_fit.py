"""Fit one control paper as the real one was fitted."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.stages import control_joint_fit

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        control_joint_fit(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.kind,
            snakemake.params.number,
            snakemake.params.settings,
        )
