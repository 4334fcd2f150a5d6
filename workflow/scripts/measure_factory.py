"""Measure both detectors under factory conditions, before and after discovery."""

from jointwear.monitor_study.factory_study import study_factory
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        study_factory(
            snakemake.input.robot,
            snakemake.wildcards.scenario,
            snakemake.output.results,
            snakemake.output.decision,
            snakemake.params.settings,
        )
