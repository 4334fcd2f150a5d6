"""Choose a reading on half of the pose sets and score it on the other."""

from jointwear.multiverse.pose_stages import choose_reading
from jointwear.script import reported

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
