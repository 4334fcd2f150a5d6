"""Copy the recovered experiment into config/."""

from jointwear.running.script import reported
from jointwear.studies.recovery.adoption import adopt_experiment

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        found, copy = snakemake.input, snakemake.params
        adopt_experiment(found.robot, found.tasks, found.wear, copy.robot, copy.tasks, copy.config)
