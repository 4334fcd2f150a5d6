"""Score the answers to the tier "world"."""

from jointwear.running.script import reported
from jointwear.studies.world.stages import write_scores

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_scores(
            snakemake.input.rows, snakemake.wildcards.world_part, snakemake.output.rows, snakemake.output.scores
        )
