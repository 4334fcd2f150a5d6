"""Generate one batch of cases of the hidden-effect test."""

from jointwear.running.script import reported
from jointwear.studies.challenge.batch import generate_batch
from jointwear.studies.challenge.plan import batch

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        generate_batch(
            batch(snakemake.wildcards.seed_set, snakemake.wildcards.tier, int(snakemake.wildcards.batch)),
            snakemake.params.seed,
            snakemake.output.data,
            snakemake.output.facts,
            snakemake.output.torque,
        )
