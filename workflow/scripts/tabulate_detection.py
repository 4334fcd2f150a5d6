"""Table IV: detection and location."""

from pathlib import Path

from jointwear.reproduction.tables import write_tables
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_tables(
            "table_iv",
            Path(snakemake.output.csv).with_suffix(""),
            snakemake.input.published,
            detections=snakemake.input.detections,
            locations=snakemake.input.locations,
        )
