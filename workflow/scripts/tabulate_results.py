"""Tables II to VI, each published value beside ours."""

from pathlib import Path

from jointwear.reproduction.tables import tabulate_results
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        tabulate_results(
            snakemake.params.tables,
            Path(snakemake.output[0]).parent,
            snakemake.input.published,
            features=snakemake.input.features,
            detections=snakemake.input.detections,
            locations=snakemake.input.locations,
            replicate=snakemake.params.replicate,
        )
