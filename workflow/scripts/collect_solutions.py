"""Collect different pose sets that reproduce the published tables."""

from jointwear.running.script import reported
from jointwear.studies.recovery.ensemble import collect_solutions

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        collect_solutions(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.fit,
            snakemake.output[0],
            snakemake.params.settings,
        )
