"""Measure which ambiguity decides the scores."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.reading_stages import measure_influence

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        measure_influence(
            snakemake.input.design,
            snakemake.input.scored,
            snakemake.output[0],
        )
