"""Draw the controls of the joint fit."""

from jointwear.running.script import reported
from jointwear.studies.joint_fit.figures import draw

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        draw("controls", snakemake.input.chapter, snakemake.output[0])
