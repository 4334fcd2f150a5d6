"""Simulate the nominal model along the measured motion."""

from jointwear.discovery.stages import simulate_nominal
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        simulate_nominal(snakemake.input.recording, snakemake.input.robot, snakemake.output[0])
