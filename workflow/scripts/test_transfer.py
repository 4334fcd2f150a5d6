"""Fit the best candidates to two tasks and test them on the third."""

from jointwear.recovery.transfer import transfer_candidates
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        transfer_candidates(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.fits,
            snakemake.output[0],
            snakemake.params.settings,
        )
