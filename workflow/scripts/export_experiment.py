"""Write the recovered arm and tasks as ordinary files."""

from jointwear.running.script import reported
from jointwear.studies.recovery.export import export_experiment

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        export_experiment(
            snakemake.input.robot,
            snakemake.input.ensemble,
            snakemake.output.robot,
            snakemake.output.tasks,
            snakemake.output.wear,
        )
