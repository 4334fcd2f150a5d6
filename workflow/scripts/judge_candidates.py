"""Compare all candidates and write the verdict."""

from jointwear.recovery.verdict import judge
from jointwear.script import reported

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
