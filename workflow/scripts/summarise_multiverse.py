"""Put the numbers of the multiverse together for the report."""

from jointwear.multiverse.summary import write_chapter
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_chapter(
            snakemake.input.scored,
            snakemake.input.influence,
            snakemake.input.choice,
            snakemake.input.mixture,
            snakemake.input.lag_rule,
            snakemake.output[0],
        )
