"""Survey the first log of a monitored robot."""

from jointwear.monitor.reading.reading_stages import survey_first_log
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0], absent=["pandas"]):
        survey_first_log(snakemake.params.first, snakemake.input.robot, snakemake.params.entry, snakemake.output[0])
