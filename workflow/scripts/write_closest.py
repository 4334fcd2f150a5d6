"""Write the closest joint experiment as an experiment of the workflow."""

from jointwear.running.script import reported
from jointwear.studies.side_by_side.experiments import write_closest

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_closest(
            snakemake.input.checked,
            snakemake.input.robot,
            list(snakemake.input.tasks),
            snakemake.params.reading,
            snakemake.output[0],
        )
