"""Choose the best setting of every peer on the choose-seeds and score it."""

from jointwear.running.script import reported
from jointwear.studies.challenge.peer_scores import write_peer_scores

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_peer_scores(
            list(zip(snakemake.input.chosen_facts, snakemake.input.chosen, strict=True)),
            list(zip(snakemake.input.facts, snakemake.input.answers, strict=True)),
            snakemake.input.rows,
            snakemake.output[0],
        )
