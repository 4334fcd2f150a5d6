"""Choose the reading under which one experiment comes closest to the whole paper."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.stages import screen_joint_readings

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        screen_joint_readings(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.settings,
        )
