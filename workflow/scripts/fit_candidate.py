"""Fit one candidate for what is missing to the published tables."""

from jointwear.running.script import reported
from jointwear.studies.recovery.fit import fit_candidate

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
