"""Put the numbers of the recovery together for the report."""

from jointwear.recovery.summary import summarise_recovery
from jointwear.script import reported

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
