"""Fetch one registered data set and convert it."""

from jointwear.measurement.fetching import fetch
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        fetch(snakemake.params.name, snakemake.params.folder, snakemake.input.registry)
