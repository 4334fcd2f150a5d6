# Many robots: a job judges a batch of them, because starting a job costs more than judging a robot. It reads each log
# once. Logs are a parameter (names, sizes, times), not inputs: a folder that is lost on the way must not stop the call.


rule fleet:
    input:
        "results/fleet/index.html",
        "results/fleet/fleet.csv",


rule watch_fleet:
    input:
        robots=lambda wildcards: sorted(
            {
                path
                for entry in fleet_entries(wildcards).values()
                for path in robot_sources(entry["robot"])
            }
        ),
        templates=PAGE_TEMPLATES,
        modules=modules_of("watch_fleet"),
    output:
        rows="results/fleet/batches/{fleet_batch}.json",
        # Which folders the robots have; by the next call one may be gone.
        notes=update("results/fleet/folders/{fleet_batch}.json"),
    log:
        "results/logs/watch_fleet/{fleet_batch}.log",
    wildcard_constraints:
        fleet_batch="[0-9a-f]{12}",
    threads: processes_of_job(len(FLEET), CORES)
    params:
        entries=fleet_entries,
        logs=lambda wildcards: {
            name: FOUND_LOGS[name] for name in FLEET[wildcards.fleet_batch]
        },
        seen=lambda wildcards: {
            name: seen(FOUND_LOGS[name], SILENT.get(name, ""))
            for name in FLEET[wildcards.fleet_batch]
        },
        unreachable=lambda wildcards: {
            name: SILENT[name]
            for name in FLEET[wildcards.fleet_batch]
            if name in SILENT
        },
        time_zone=MONITOR["time_zone"],
        robots=len(MONITOR["robots"]),
        folder="results/fleet/robots",
        configuration=CONFIGURATION,
        # A robot whose folder was deleted or moved away is read and judged again.
        begun=lambda wildcards: begun_anew(wildcards.fleet_batch),
    script:
        "../scripts/watch_fleet.py"


rule summarise_fleet:
    input:
        batches=fleet_batches,
        templates=templates("fleet.html.j2", "robots.html.j2"),
        modules=modules_of("summarise_fleet"),
    output:
        table="results/fleet/fleet.csv",
        page="results/fleet/index.html",
        metrics="results/fleet/metrics.prom",
        history="results/fleet/history.parquet",
        rows="results/fleet/rows.json",
    log:
        "results/logs/summarise_fleet.log",
    params:
        folder="results/fleet/robots",
        outbox="results/fleet/outbox.json",
        time_zone=MONITOR["time_zone"],
        stale_after=window_seconds(MONITOR["stale_after"]) / 3600,
        configuration=CONFIGURATION,
        # What is stale depends on the time of day: the page is as of the hour.
        hour=int(time.time() // 3600),
    script:
        "../scripts/summarise_fleet.py"


# A target of its own: pages, dry runs and tests send nothing, and a call at which no result changes still sends what
# could not be sent before. No output: it runs at every call.
rule notify:
    input:
        rows="results/fleet/rows.json",
        page="results/fleet/index.html",
    log:
        "results/logs/notify.log",
    localrule: True
    params:
        channels=MONITOR["notify"],
        outbox="results/fleet/outbox.json",
        metrics="results/fleet/messages.prom",
        time_zone=MONITOR["time_zone"],
    script:
        "../scripts/notify.py"
