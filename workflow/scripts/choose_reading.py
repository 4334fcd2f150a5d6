"""Choose a reading on half of the pose sets and score it on the other."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.pose_stages import choose_reading

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        choose_reading(
            snakemake.input.best,
            snakemake.input.parts,
            snakemake.input.ensemble,
            snakemake.input.unloaded,
            snakemake.input.tasks,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.settings,
        )
