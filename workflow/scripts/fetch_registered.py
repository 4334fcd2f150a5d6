"""Fetch one registered data set and convert it."""

from pathlib import Path

from jointwear.measurement.fetching import fetch
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        fetch(snakemake.params.name, Path(snakemake.output[0]).parent, snakemake.input.registry)
