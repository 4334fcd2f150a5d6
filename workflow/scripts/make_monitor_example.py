"""Make the shipped logs of the monitoring example."""

from jointwear.running.script import reported
from jointwear.studies.monitor_study.example import write_example

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_example(snakemake.input.robot, snakemake.output)
