"""Count how many hidden causes were named rightly."""

from jointwear.running.script import reported
from jointwear.studies.recovery.summary import summarise_validation_chapter
from jointwear.studies.recovery.validation import summarise_validation

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        summarise_validation(snakemake.input.cases, snakemake.output.netcdf)
        summarise_validation_chapter(snakemake.output.netcdf, snakemake.output.chapter)
