"""Compare all candidates and write the verdict."""

from jointwear.running.script import reported
from jointwear.studies.recovery.verdict import judge

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        judge(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.fits,
            snakemake.input.transfer,
            snakemake.input.ensemble,
            snakemake.output.verdict,
            snakemake.output.comparison,
        )
