"""Generate one batch of cases of the hidden-effect test."""

from jointwear.challenge.batch import generate_batch
from jointwear.challenge.plan import batch
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        generate_batch(
            batch(snakemake.wildcards.seed_set, snakemake.wildcards.tier, int(snakemake.wildcards.batch)),
            snakemake.input.robot,
            snakemake.params.seed,
            snakemake.output.data,
            snakemake.output.facts,
            snakemake.output.torque,
        )
