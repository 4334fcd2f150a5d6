"""Write the page of one data set."""

from jointwear.discovery.presentation.page import write_page
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_page(
            snakemake.input.verdict,
            snakemake.input.where,
            snakemake.input.models,
            snakemake.output.page,
            snakemake.output.figures,
            next(iter(snakemake.input.published), None),
        )
