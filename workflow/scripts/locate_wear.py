"""Locate the worn axis of a run by the lags between axes."""

from jointwear.reproduction.location import write_location
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_location(
            snakemake.input.features,
            snakemake.input.training,
            snakemake.input.get("detection"),
            snakemake.output[0],
            snakemake.params.settings,
        )
