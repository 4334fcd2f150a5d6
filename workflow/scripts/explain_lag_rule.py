"""Show why the published way of locating wear works."""

from jointwear.running.script import reported
from jointwear.studies.multiverse.lag_rule import write_lag_rule

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_lag_rule(
            snakemake.input.robot,
            snakemake.input.tasks,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.settings,
        )
