"""Table II: lags between the axes."""

from pathlib import Path

from jointwear.script import reported
from jointwear.tables import write_tables

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_tables(
            "table_ii",
            Path(snakemake.output.csv).with_suffix(""),
            snakemake.input.published,
            locations=snakemake.input.locations,
            replicate=snakemake.params.replicate,
        )
