"""Make the shipped logs of the monitoring example."""

from jointwear.monitor.example import write_example
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_example(snakemake.input.robot, snakemake.output)
