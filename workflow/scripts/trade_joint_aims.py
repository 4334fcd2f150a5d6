"""Search the nearest joint experiments on under other weights."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.stages import trade_joint_aims

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        trade_joint_aims(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.confirmed,
            snakemake.output[0],
            snakemake.params.settings,
        )
