"""Assemble the results of the multiverse for the report."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.summary import write_chapter

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_chapter(
            snakemake.input.scored,
            snakemake.input.influence,
            snakemake.input.choice,
            snakemake.input.mixture,
            snakemake.input.lag_rule,
            snakemake.output[0],
        )
