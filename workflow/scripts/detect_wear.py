"""Score a run against the normal model and find the onset of wear."""

from jointwear.reproduction.detection import write_detection
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_detection(snakemake.input.features, snakemake.input.model, snakemake.output[0], snakemake.params.settings)
