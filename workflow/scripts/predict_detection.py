"""Predict Table IV from pose sets fitted to Tables V and VI alone."""

from jointwear.running.script import reported
from jointwear.studies.recovery.prediction import predict_detection

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        predict_detection(
            snakemake.input.robot,
            snakemake.input.published,
            snakemake.input.ensemble,
            snakemake.output[0],
            snakemake.params.settings,
        )
