"""Keep the nearest joint experiments and check the closest one on new random numbers."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.posterior import write_posterior

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_posterior(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.confirmed,
            snakemake.input.traded,
            snakemake.output.table,
            snakemake.output.checked,
            snakemake.output.robot,
            list(snakemake.output.tasks),
            snakemake.params.settings,
        )
