"""Write the small summary of the hidden-effect test."""

from dataclasses import asdict

from jointwear.discovery.settings import Settings
from jointwear.running.script import reported
from jointwear.studies.hidden_effect_page.stored import write_stored

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_stored(
            snakemake.input.scores,
            snakemake.output[0],
            snakemake.wildcards.part,
            snakemake.params.seed,
            asdict(Settings()),
        )
