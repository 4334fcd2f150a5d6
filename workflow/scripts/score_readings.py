"""Score all readings against the paper."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.reading_stages import score_readings

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        score_readings(
            snakemake.input.design,
            snakemake.input.parts,
            snakemake.input.published,
            snakemake.output.netcdf,
            snakemake.output.csv,
            snakemake.output.best,
            snakemake.output.start,
            snakemake.params.settings,
        )
