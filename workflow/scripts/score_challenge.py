"""Judge the verdicts of a seed set against the truth."""

from jointwear.running.script import reported
from jointwear.studies.challenge.scoring import write_scores

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_scores(
            list(zip(snakemake.input.facts, snakemake.input.truth_torque, strict=True)),
            list(zip(snakemake.input.verdicts, snakemake.input.verdict_torque, strict=True)),
            snakemake.output.rows,
            snakemake.output.scores,
        )
