"""Learn the model of one robot from the logs of its baseline."""

from pathlib import Path

from jointwear.monitor.learned.stage import learn_normal
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        learn_normal(snakemake.wildcards.monitored, snakemake.params.entry, Path(snakemake.output.learned).parent)
