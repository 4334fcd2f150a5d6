"""Find what the model of one data set lacks."""

from pathlib import Path

from jointwear.discovery.stages import discover_dataset
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        discover_dataset(
            snakemake.wildcards.dataset,
            snakemake.params.entry,
            snakemake.input.robot,
            Path(snakemake.output.verdict).parent,
            snakemake.log[0],
        )
