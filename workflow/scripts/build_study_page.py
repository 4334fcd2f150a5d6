"""Build the page of one study."""

from jointwear.publishing.report.study_page import write_study_page
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_study_page(
            snakemake.params.study, snakemake.input.chapter, list(snakemake.input.figures), snakemake.output[0]
        )
