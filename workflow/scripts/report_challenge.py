"""Write the page of the hidden-effect test."""

from jointwear.challenge.page import write_page
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_page(
            snakemake.input.scores,
            snakemake.input.get("peers") or None,
            snakemake.output[0],
            snakemake.wildcards.part,
            snakemake.params.seed,
        )
