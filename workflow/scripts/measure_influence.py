"""Measure which ambiguity decides the scores."""

from jointwear.multiverse.reading_stages import measure_influence
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        measure_influence(
            snakemake.input.design,
            snakemake.input.scored,
            snakemake.output[0],
        )
