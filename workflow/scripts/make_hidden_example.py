"""Make the small shipped data set with a hidden effect."""

from jointwear.challenge.examples import write_hidden_example
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_hidden_example(snakemake.input.robot, snakemake.output[0])
