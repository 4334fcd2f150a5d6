"""Judge all windows of a monitored robot."""

from jointwear.monitor.stages import judge_windows
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        judge_windows(
            snakemake.input.windows,
            snakemake.input.robot,
            snakemake.params.entry,
            snakemake.output.state,
            snakemake.output.alarms,
            snakemake.output.recall,
            snakemake.wildcards.monitored,
            snakemake.input.survey,
        )
