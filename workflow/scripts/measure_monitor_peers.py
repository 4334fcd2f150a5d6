"""Measure other detectors on the runs of one task."""

from jointwear.running.script import reported
from jointwear.studies.monitor_study.peers import study_peers

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        study_peers(
            snakemake.input.features, snakemake.input.runs, snakemake.output[0], snakemake.params.settings
        )  # fmt: skip
