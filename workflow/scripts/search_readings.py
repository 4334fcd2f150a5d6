"""Search on from the scored readings."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.pose_stages import search_readings

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        search_readings(
            snakemake.input.design,
            snakemake.input.start,
            snakemake.input.ensemble,
            snakemake.input.unloaded,
            snakemake.input.published,
            snakemake.output.best,
            snakemake.output.all,
            snakemake.params.part,
            snakemake.params.settings,
        )
