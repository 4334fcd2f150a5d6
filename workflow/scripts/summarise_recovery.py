"""Assemble the results of the recovery for the report."""

from jointwear.running.script import reported
from jointwear.studies.recovery.summary import summarise_recovery

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        found = snakemake.input
        summarise_recovery(
            found.bound,
            found.verdict,
            found.comparison,
            found.transfer,
            found.ensemble,
            found.prediction,
            snakemake.output[0],
        )
