"""Fit the best candidates to two tasks and test them on the third."""

from jointwear.running.script import reported
from jointwear.studies.recovery.transfer import transfer_candidates

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        transfer_candidates(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.fits,
            snakemake.output[0],
            snakemake.params.settings,
        )
