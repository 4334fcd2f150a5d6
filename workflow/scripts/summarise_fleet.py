"""Write the table of the fleet."""

from jointwear.monitor.fleet.watch import summarise_fleet
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        summarise_fleet(snakemake.input.batches, snakemake.output[0])
