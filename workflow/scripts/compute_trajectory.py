"""Compute the motion of a task and the path of the end effector."""

from jointwear.reproduction.commanded_motion import write_trajectory
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_trajectory(snakemake.input.robot, snakemake.input.task, snakemake.output[0])
