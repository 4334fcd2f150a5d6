"""Read and check one measured data set."""

from jointwear.discovery.stages import ingest_recording
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        ingest_recording(
            snakemake.wildcards.dataset, snakemake.params.entry, snakemake.input.robot, snakemake.output[0]
        )
