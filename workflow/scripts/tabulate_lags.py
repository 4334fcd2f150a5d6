"""Table II: lags between the axes."""

from pathlib import Path

from jointwear.reproduction.tables import write_tables
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_tables(
            "table_ii",
            Path(snakemake.output.csv).with_suffix(""),
            snakemake.input.published,
            locations=snakemake.input.locations,
            replicate=snakemake.params.replicate,
        )
