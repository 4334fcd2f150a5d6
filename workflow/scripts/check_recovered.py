"""Hold the copies of the recovered experiment in config/ to a new recovery."""

from jointwear.running.script import reported
from jointwear.studies.recovery.adoption import compare_copies

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        compare_copies(
            snakemake.input.recovered, snakemake.input.copies, snakemake.output[0], snakemake.params.tolerance
        )
