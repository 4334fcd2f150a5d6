"""Show why the published way of locating wear works."""

from jointwear.multiverse.lag_rule import write_lag_rule
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_lag_rule(
            snakemake.input.robot,
            snakemake.input.tasks,
            snakemake.input.published,
            snakemake.output[0],
            snakemake.params.settings,
        )
