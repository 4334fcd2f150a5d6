"""Write the page, the table, the metrics and the history of the fleet."""

import sys

from jointwear.monitor.fleet.summary import summarise_fleet
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0], absent=["pandas"]):
        summarise_fleet(
            snakemake.input.batches,
            snakemake.params.folder,
            snakemake.output.table,
            snakemake.output.page,
            snakemake.output.metrics,
            snakemake.output.history,
            snakemake.output.rows,
            outbox=snakemake.params.outbox,
            time_zone=snakemake.params.time_zone,
            stale_after=snakemake.params.stale_after,
            configuration=snakemake.params.configuration,
        )
        if not snakemake.input.batches:
            # A schedule that lost its --configfile must not look healthy.
            print("jointwear: the configuration names no robot under 'monitor.robots'", file=sys.stderr)
