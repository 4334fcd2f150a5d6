"""Write the page of the hidden-effect test."""

from jointwear.running.script import reported
from jointwear.studies.hidden_effect_page.page import write_page

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_page(
            snakemake.input.scores,
            snakemake.input.get("peers") or None,
            snakemake.output[0],
            snakemake.wildcards.part,
            snakemake.params.seed,
        )
