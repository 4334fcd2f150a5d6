"""Table V: maximum torque."""

from pathlib import Path

from jointwear.reproduction.tables import write_tables
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_tables(
            "table_v",
            Path(snakemake.output.csv).with_suffix(""),
            snakemake.input.published,
            features=snakemake.input.features,
            detections=snakemake.input.detections,
        )
