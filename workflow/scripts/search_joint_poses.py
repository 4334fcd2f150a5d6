"""Search poses of all tasks for one part of the arms."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.stages import search_joint_poses

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        search_joint_poses(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.chosen,
            snakemake.output[0],
            snakemake.params.part,
            snakemake.params.settings,
        )
