"""Choose the readings of the multiverse."""

from jointwear.multiverse.reading_stages import sample_readings
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        sample_readings(
            snakemake.output[0],
            snakemake.params.settings,
        )
