"""Run joint experiments again with random numbers that took no part."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.stages import confirm_joint_fit

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        confirm_joint_fit(
            snakemake.input.robot,
            snakemake.input.published,
            list(snakemake.input.searched),
            snakemake.output[0],
            snakemake.params.settings,
        )
