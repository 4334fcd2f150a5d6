"""Simulate again with the retuned and the augmented robot."""

from jointwear.discovery.stages import simulate_models
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        simulate_models(
            snakemake.input.nominal,
            snakemake.input.recording,
            snakemake.input.robot,
            snakemake.input.retuned,
            snakemake.output[0],
        )
