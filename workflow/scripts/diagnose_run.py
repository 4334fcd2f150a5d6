"""Find the onset of wear in a run, and locate the worn axis."""

from jointwear.reproduction.diagnosis import diagnose_run
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        diagnose_run(
            snakemake.input.features,
            snakemake.input.training,
            snakemake.input.model,
            detection=snakemake.output.detection,
            location=snakemake.output.location,
            detection_settings=snakemake.params.detection,
            location_settings=snakemake.params.location,
        )
