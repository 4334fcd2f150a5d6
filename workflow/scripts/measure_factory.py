"""Measure both detectors under factory conditions, before and after discovery."""

from jointwear.running.script import reported
from jointwear.studies.monitor_study.factory_study import study_factory

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        study_factory(
            snakemake.input.robot,
            snakemake.wildcards.scenario,
            snakemake.output.results,
            snakemake.output.decision,
            snakemake.params.settings,
        )
