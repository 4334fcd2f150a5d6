"""Tell where the nominal model disagrees."""

from jointwear.discovery.stages import locate_discrepancy
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        locate_discrepancy(
            snakemake.input.recording, snakemake.input.robot, snakemake.output[0], snakemake.params.entry
        )
