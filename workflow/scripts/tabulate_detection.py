"""Table IV: detection and location."""

from pathlib import Path

from jointwear.script import reported
from jointwear.tables import write_tables

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_tables(
            "table_iv",
            Path(snakemake.output.csv).with_suffix(""),
            snakemake.input.published,
            detections=snakemake.input.detections,
            locations=snakemake.input.locations,
        )
