"""Assemble the results of the joint fit for the report."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.summary import write_chapter

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_chapter(
            snakemake.input.limits,
            snakemake.input.published,
            snakemake.input.screened,
            snakemake.input.confirmed,
            snakemake.input.traded,
            snakemake.input.checked,
            snakemake.output[0],
            snakemake.params.kept,
        )
