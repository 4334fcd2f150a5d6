"""Make the torque log of a task over many hours, with a hidden temperature dependence."""

from jointwear.running.script import reported
from jointwear.studies.challenge.examples import write_warm_task

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_warm_task(
            snakemake.input.robot,
            snakemake.input.task,
            snakemake.output[0],
            snakemake.params.settings,
            snakemake.params.seed,
        )
