"""Table III: the design of the experiment."""

from pathlib import Path

from jointwear.reproduction.tables import write_tables
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_tables(
            "table_iii",
            Path(snakemake.output.csv).with_suffix(""),
            snakemake.input.published,
            detections=snakemake.input.detections,
        )
