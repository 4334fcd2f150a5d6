# Many robots: a job judges a batch of them, because starting a job costs more than judging a robot.
from jointwear.monitor.fleet.plan import batches

FLEET_LOGS = {
    name: [log for logs in jobs.values() for log in logs] for name, jobs in LOGS.items()
}
FLEET = batches(list(FLEET_LOGS))


rule fleet:
    input:
        "results/fleet/fleet.csv",


rule watch_fleet:
    input:
        logs=lambda wildcards: [
            path
            for name in FLEET[wildcards.fleet_batch]
            for log in FLEET_LOGS[name]
            for path in log_sources(log)
        ],
        robots=lambda wildcards: sorted(
            {
                path
                for name in FLEET[wildcards.fleet_batch]
                for path in robot_sources(config["monitor"]["robots"][name]["robot"])
            }
        ),
        modules=modules_of("watch_fleet"),
    output:
        "results/fleet/batches/{fleet_batch}.json",
    log:
        "results/logs/watch_fleet/{fleet_batch}.log",
    wildcard_constraints:
        fleet_batch="[0-9]{4}",
    params:
        entries=lambda wildcards: {
            name: dict(config["monitor"]["robots"][name])
            for name in FLEET[wildcards.fleet_batch]
        },
        logs=lambda wildcards: {
            name: FLEET_LOGS[name] for name in FLEET[wildcards.fleet_batch]
        },
        folder="results/fleet/robots",
    script:
        "../scripts/watch_fleet.py"


rule summarise_fleet:
    input:
        batches=expand("results/fleet/batches/{fleet_batch}.json", fleet_batch=FLEET),
        modules=modules_of("summarise_fleet"),
    output:
        "results/fleet/fleet.csv",
    log:
        "results/logs/summarise_fleet.log",
    script:
        "../scripts/summarise_fleet.py"
