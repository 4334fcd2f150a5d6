"""Measure the gap on held-out motion and complete the verdict."""

from jointwear.discovery.stages import measure_gap
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        measure_gap(snakemake.input.decision, snakemake.input.models, snakemake.input.recording, snakemake.output[0])
