"""Make the small shipped data set with a hidden effect."""

from jointwear.running.script import reported
from jointwear.studies.challenge.examples import write_hidden_example

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_hidden_example(snakemake.input.robot, snakemake.output[0])
