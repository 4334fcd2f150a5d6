"""Run the poses that Table IV would choose once more, with new random numbers."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.pose_stages import confirm_mixture

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        confirm_mixture(
            snakemake.input.best,
            snakemake.input.chosen,
            snakemake.input.ensemble,
            snakemake.input.unloaded,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.settings,
        )
