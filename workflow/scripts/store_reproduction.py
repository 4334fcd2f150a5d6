"""Write the verdicts of the report that are kept with the project."""

from jointwear.publishing.report.stored import write_stored
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_stored(snakemake.input.scores, snakemake.output[0])
