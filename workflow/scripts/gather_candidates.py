"""Put together the readings that go on to the pose sets."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.pose_stages import gather_candidates

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        gather_candidates(
            snakemake.input.best,
            snakemake.input.searches,
            snakemake.output[0],
            snakemake.params.settings,
        )
