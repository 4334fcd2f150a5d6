"""Judge a batch of robots."""

from jointwear.monitor.fleet.watch import watch_robots
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0], absent=["pandas"]):
        watch_robots(
            snakemake.params.entries,
            snakemake.params.logs,
            snakemake.params.folder,
            snakemake.output.rows,
            unreachable=snakemake.params.unreachable,
            time_zone=snakemake.params.time_zone,
            robots=snakemake.params.robots,
            processes=snakemake.threads,
            configuration=snakemake.params.configuration,
            begun=snakemake.params.begun,
            notes=snakemake.output.notes,
        )
