"""Write the small summary of the hidden-effect test."""

from dataclasses import asdict

from jointwear.challenge.stored import write_stored
from jointwear.discovery.settings import Settings
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_stored(
            snakemake.input.scores,
            snakemake.output[0],
            snakemake.wildcards.part,
            snakemake.params.seed,
            asdict(Settings()),
        )
