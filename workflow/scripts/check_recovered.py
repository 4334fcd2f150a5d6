"""Hold the copies of the recovered experiment in config/ to a new recovery."""

from jointwear.recovery.adoption import compare_copies
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        compare_copies(
            snakemake.input.recovered, snakemake.input.copies, snakemake.output[0], snakemake.params.tolerance
        )
