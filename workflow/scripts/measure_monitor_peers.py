"""Measure other detectors on the runs of one task."""

from jointwear.monitor_study.peers import study_peers
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        study_peers(
            snakemake.input.features, snakemake.input.runs, snakemake.output[0], snakemake.params.settings
        )  # fmt: skip
