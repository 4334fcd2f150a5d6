"""Run the best readings on one part of the pose sets."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.pose_stages import evaluate_pose_sets

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        evaluate_pose_sets(
            snakemake.input.best,
            snakemake.input.ensemble,
            snakemake.input.unloaded,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.part,
            snakemake.params.settings,
        )
