"""Choose the readings of the multiverse."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.reading_stages import sample_readings

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        sample_readings(
            snakemake.output[0],
            snakemake.params.settings,
        )
