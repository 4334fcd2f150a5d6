# Monitoring: survey the first log -> window statistics of every log -> judge -> page. A new log costs its own windows.


wildcard_constraints:
    monitored="[A-Za-z][A-Za-z0-9_]*",
    batch_key="[A-Za-z0-9_-]+",


rule monitor:
    input:
        of_chosen_robots(
            "results/monitor/{monitored}/{file}",
            file=["alarms.csv", "state.nc", "monitor.html"],
        ),


rule survey_logs:
    input:
        robot=monitored_robot,
        model=monitored_model,
        modules=modules_of("survey_logs"),
    output:
        # Beside it the rule keeps surveys.json, which the first log is chosen by. It is no output: where it is missing
        # every log would be read anew.
        "results/monitor/{monitored}/survey.json",
    log:
        "results/logs/survey_logs/{monitored}.log",
    params:
        # No input: a kept survey stands for a log that may be gone, and a log that is copied anew surveys nothing anew.
        first=first_log,
        entry=reading_entry,
    script:
        "../scripts/survey_logs.py"


rule accumulate_windows:
    input:
        logs=batch_files,
        survey="results/monitor/{monitored}/survey.json",
        robot=monitored_robot,
        model=monitored_model,
        modules=modules_of("accumulate_windows"),
    output:
        "results/monitor/{monitored}/windows/{batch_key}.nc",
    log:
        "results/logs/accumulate_windows/{monitored}/{batch_key}.log",
    params:
        logs=batch_logs,
        entry=reading_entry,
    script:
        "../scripts/accumulate_windows.py"


rule judge_windows:
    input:
        windows=window_files,
        survey="results/monitor/{monitored}/survey.json",
        robot=monitored_robot,
        model=monitored_model,
        modules=modules_of("judge_windows"),
    output:
        # Beside it the rule keeps baseline.nc. It is no output: these are there after every job, and this one only once
        # the baseline is complete and until a user moves it away.
        state="results/monitor/{monitored}/state.nc",
        alarms="results/monitor/{monitored}/alarms.csv",
        # What the baseline told the last time: it spares a search and changes no number.
        recall=update("results/monitor/{monitored}/recall.json"),
    log:
        "results/logs/judge_windows/{monitored}.log",
    params:
        entry=monitored_entry,
    script:
        "../scripts/judge_windows.py"


rule report_monitoring:
    input:
        state="results/monitor/{monitored}/state.nc",
        templates=PAGE_TEMPLATES,
        modules=modules_of("report_monitoring"),
    output:
        page="results/monitor/{monitored}/monitor.html",
        figures=directory("results/monitor/{monitored}/figures"),
    log:
        "results/logs/report_monitoring/{monitored}.log",
    params:
        time_zone=config["monitor"]["time_zone"],
        # A robot that the configuration does not name is a shipped example.
        example=lambda wildcards: wildcards.monitored not in config["monitor"]["robots"],
    script:
        "../scripts/report_monitoring.py"


MONITOR_EXAMPLE = expand(
    "results/examples/monitor_puma560/day_{day}",
    day=["1.nc", "2.parquet", "3.csv", "4.parquet", "5.nc"],
)


rule make_monitor_example:
    input:
        robot=shipped("config/robots/puma560.yaml"),
        modules=modules_of("make_monitor_example"),
    output:
        MONITOR_EXAMPLE,
    log:
        "results/logs/make_monitor_example.log",
    script:
        "../scripts/make_monitor_example.py"
