"""Fit one candidate for what is missing to the published tables."""

from jointwear.recovery.fit import fit_candidate
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        fit_candidate(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.simpler,
            snakemake.output[0],
            snakemake.wildcards.candidate,
            snakemake.params.settings,
        )
