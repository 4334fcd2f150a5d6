"""Copy the recovered experiment into config/."""

from jointwear.recovery.adoption import adopt_experiment
from jointwear.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        found, copy = snakemake.input, snakemake.params
        adopt_experiment(found.robot, found.tasks, found.wear, copy.robot, copy.tasks, copy.config)
