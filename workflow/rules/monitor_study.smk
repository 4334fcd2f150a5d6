# Study of the monitor on the runs of the reproduction, beside peers, and under factory conditions (docs: monitor).
wildcard_constraints:
    scenario="|".join(MONITOR_SCENARIOS),


rule monitor_study:
    input:
        "results/monitor_study/chapter.json",
        "results/monitor_study/index.html",


rule measure_monitor:
    input:
        robot=config["robot"],
        task=task_file,
        runs=runs_of("simulation", "training", "normal"),
        detection=runs_of("detection", "normal"),
        location=runs_of("location"),
        modules=modules_of("measure_monitor"),
    output:
        "results/monitor_study/grid/{task}.nc",
    log:
        "results/logs/measure_monitor/{task}.log",
    params:
        settings={
            "seed": config["seed"],
            "replicates": config["replicates"],
            "shape": config["wear"]["shape"],
            "wear_hours": config["wear"]["hours"],
            "time_step": config["noise"]["time_step"],
            "interval": config["sampling"]["interval"],
            "samples": config["sampling"]["samples"],
            "consecutive_hours": config["detection"]["consecutive_hours"],
        },
    script:
        "../scripts/measure_monitor.py"


rule measure_monitor_peers:
    input:
        features=runs_of("features", "training", "normal"),
        runs=runs_of("simulation", "training", "normal"),
        modules=modules_of("measure_monitor_peers"),
    output:
        "results/monitor_study/peers/{task}.nc",
    log:
        "results/logs/measure_monitor_peers/{task}.log",
    params:
        settings={
            "seed": config["seed"],
            "peer_replicates": min(20, config["replicates"]),
        },
    script:
        "../scripts/measure_monitor_peers.py"


rule measure_factory:
    input:
        robot=shipped("config/robots/puma560.yaml"),
        modules=modules_of("measure_factory"),
    output:
        results="results/monitor_study/factory/{scenario}/factory.nc",
        decision="results/monitor_study/factory/{scenario}/decisions.json",
    log:
        "results/logs/measure_factory/{scenario}.log",
    params:
        settings={
            **MONITOR_PAPER,
            "seed": config["seed"],
            "factory_replicates": 8,
            "reading": {**reading_of(config, "features"), **MODEL_READING},
        },
    script:
        "../scripts/measure_factory.py"


rule summarise_monitor_study:
    input:
        grid=expand("results/monitor_study/grid/{task}.nc", task=MONITOR_TASKS),
        peers=expand("results/monitor_study/peers/{task}.nc", task=MONITOR_TASKS),
        factory=expand(
            "results/monitor_study/factory/{scenario}/factory.nc",
            scenario=MONITOR_SCENARIOS,
        ),
        decisions=expand(
            "results/monitor_study/factory/{scenario}/decisions.json",
            scenario=MONITOR_SCENARIOS,
        ),
        published=PUBLISHED,
        modules=modules_of("summarise_monitor_study"),
    output:
        "results/monitor_study/chapter.json",
    log:
        "results/logs/summarise_monitor_study.log",
    params:
        tasks=MONITOR_TASKS,
        scenarios=MONITOR_SCENARIOS,
        seed=config["seed"],
    script:
        "../scripts/summarise_monitor_study.py"


rule draw_monitor_study:
    input:
        chapter="results/monitor_study/chapter.json",
        modules=modules_of("draw_monitor_study"),
    output:
        "results/monitor_study/figures/{drawing}.svg",
    log:
        "results/logs/draw_monitor_study/{drawing}.log",
    wildcard_constraints:
        drawing="|".join(MONITOR_STUDY_FIGURES),
    script:
        "../scripts/draw_monitor_study.py"
