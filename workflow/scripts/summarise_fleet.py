"""Write the page, the table, the metrics and the history of the fleet."""

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
