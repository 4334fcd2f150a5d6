# Hundreds of readings of the paper's text on one pose set, the best of them on many (docs: multiverse).
MULTIVERSE_TASKS = ["T1", "T2", "T3"]  # the tasks that the paper tabulates
MULTIVERSE_TASK_FILES = [
    shipped(f"config/tasks/{task}.yaml") for task in MULTIVERSE_TASKS
]
MULTIVERSE_ENSEMBLE = "results/recovery/ensemble_published_hours.nc"
MULTIVERSE_READINGS = 540
MULTIVERSE_BEST = 20
MULTIVERSE_POSE_SETS = 50
MULTIVERSE_PARTS = 8
MULTIVERSE_POSE_PARTS = 10
# The search goes on from the design in independent islands, on the first few pose sets of the ensemble.
MULTIVERSE_ISLANDS = 2
MULTIVERSE_SEARCH_POSE_SETS = 4
MULTIVERSE_DEFAULT = {
    "reading": config["reading"],
    "wear_shape": config["wear"]["shape"],
    "consecutive_hours": config["detection"]["consecutive_hours"],
}
# What every reading shares, whatever it reads.
MULTIVERSE_ANALYSIS = {
    "bins": config["histogram"]["bins"],
    "confidence": config["detection"]["confidence"],
    "variance_share": config["detection"]["variance_share"],
}
MULTIVERSE_EXPERIMENT = {
    **MULTIVERSE_ANALYSIS,
    "seed": config["seed"],
    "noise": config["noise"],
    "sampling": config["sampling"],
    "wear_hours": config["wear"]["hours"],
    "normal_hours": config["normal"]["test_hours"],
}
MULTIVERSE_FIGURES = ["readings", "influence", "cells", "lag_rule"]
STUDY_PICTURES["multiverse"] = MULTIVERSE_FIGURES


wildcard_constraints:
    part="[0-9]+",
    picture="|".join(MULTIVERSE_FIGURES),


rule multiverse:
    input:
        "results/multiverse/readings.csv",
        "results/multiverse/influence.nc",
        "results/multiverse/choice.nc",
        "results/multiverse/lag_rule.nc",
        "results/multiverse/index.html",


rule sample_readings:
    input:
        modules=modules_of("sample_readings"),
    output:
        "results/multiverse/design.csv",
    log:
        "results/logs/sample_readings.log",
    params:
        settings={
            **MULTIVERSE_DEFAULT,
            "seed": config["seed"],
            "readings": MULTIVERSE_READINGS,
            "pairs": 100,
            "simulations": 16,
        },
    script:
        "../scripts/sample_readings.py"


rule evaluate_readings:
    input:
        design="results/multiverse/design.csv",
        robot=config["robot"],
        tasks=MULTIVERSE_TASK_FILES,
        published=PUBLISHED,
        modules=modules_of("evaluate_readings"),
    output:
        "results/multiverse/readings/part_{part}.nc",
    log:
        "results/logs/evaluate_readings/{part}.log",
    params:
        part=lambda wildcards: int(wildcards.part),
        settings={
            **MULTIVERSE_EXPERIMENT,
            "replicates": 20,
            "parts": MULTIVERSE_PARTS,
        },
    script:
        "../scripts/evaluate_readings.py"


rule score_readings:
    input:
        design="results/multiverse/design.csv",
        parts=expand(
            "results/multiverse/readings/part_{part}.nc", part=range(MULTIVERSE_PARTS)
        ),
        published=PUBLISHED,
        modules=modules_of("score_readings"),
    output:
        netcdf="results/multiverse/readings.nc",
        csv="results/multiverse/readings.csv",
        best="results/multiverse/best.csv",
        start="results/multiverse/start.csv",
    log:
        "results/logs/score_readings.log",
    params:
        settings={**MULTIVERSE_ANALYSIS, "best": MULTIVERSE_BEST, "start": 100},
    script:
        "../scripts/score_readings.py"


rule measure_influence:
    input:
        design="results/multiverse/design.csv",
        scored="results/multiverse/readings.nc",
        modules=modules_of("measure_influence"),
    output:
        "results/multiverse/influence.nc",
    log:
        "results/logs/measure_influence.log",
    script:
        "../scripts/measure_influence.py"


rule search_readings:
    input:
        design="results/multiverse/design.csv",
        start="results/multiverse/start.csv",
        ensemble=MULTIVERSE_ENSEMBLE,
        unloaded=shipped("config/robots/puma560.yaml"),
        published=PUBLISHED,
        modules=modules_of("search_readings"),
    output:
        best="results/multiverse/search/best_{part}.csv",
        all="results/multiverse/search/all_{part}.csv",
    log:
        "results/logs/search_readings/{part}.log",
    params:
        part=lambda wildcards: int(wildcards.part),
        settings={
            **MULTIVERSE_EXPERIMENT,
            "search_pose_sets": MULTIVERSE_SEARCH_POSE_SETS,
            "search_replicates": 5,
            "generations": 6,
            "children": 60,
            "survivors": 20,
            "kept": MULTIVERSE_BEST,
        },
    script:
        "../scripts/search_readings.py"


rule gather_candidates:
    input:
        best="results/multiverse/best.csv",
        searches=expand(
            "results/multiverse/search/best_{part}.csv",
            part=range(MULTIVERSE_ISLANDS),
        ),
        modules=modules_of("gather_candidates"),
    output:
        "results/multiverse/candidates.csv",
    log:
        "results/logs/gather_candidates.log",
    params:
        settings={"best": MULTIVERSE_BEST},
    script:
        "../scripts/gather_candidates.py"


rule evaluate_pose_sets:
    input:
        best="results/multiverse/candidates.csv",
        ensemble=MULTIVERSE_ENSEMBLE,
        unloaded=shipped("config/robots/puma560.yaml"),
        published=PUBLISHED,
        modules=modules_of("evaluate_pose_sets"),
    output:
        "results/multiverse/pose_sets/part_{part}.nc",
    log:
        "results/logs/evaluate_pose_sets/{part}.log",
    params:
        part=lambda wildcards: int(wildcards.part),
        settings={
            **MULTIVERSE_EXPERIMENT,
            "pose_sets": MULTIVERSE_POSE_SETS,
            "pose_parts": MULTIVERSE_POSE_PARTS,
            "pose_replicates": 10,
        },
    script:
        "../scripts/evaluate_pose_sets.py"


rule choose_reading:
    input:
        best="results/multiverse/candidates.csv",
        parts=expand(
            "results/multiverse/pose_sets/part_{part}.nc",
            part=range(MULTIVERSE_POSE_PARTS),
        ),
        ensemble=MULTIVERSE_ENSEMBLE,
        unloaded=shipped("config/robots/puma560.yaml"),
        tasks=MULTIVERSE_TASK_FILES,
        published=PUBLISHED,
        modules=modules_of("choose_reading"),
    output:
        "results/multiverse/choice.nc",
    log:
        "results/logs/choose_reading.log",
    params:
        settings={
            **MULTIVERSE_ANALYSIS,
            "seed": config["seed"],
            "search_pose_sets": MULTIVERSE_SEARCH_POSE_SETS,
        },
    script:
        "../scripts/choose_reading.py"


rule confirm_mixture:
    input:
        best="results/multiverse/candidates.csv",
        chosen="results/multiverse/choice.nc",
        ensemble=MULTIVERSE_ENSEMBLE,
        unloaded=shipped("config/robots/puma560.yaml"),
        published=PUBLISHED,
        modules=modules_of("confirm_mixture"),
    output:
        "results/multiverse/mixture.nc",
    log:
        "results/logs/confirm_mixture.log",
    params:
        settings={**MULTIVERSE_EXPERIMENT, "confirm_replicates": 100},
    script:
        "../scripts/confirm_mixture.py"


rule explain_lag_rule:
    input:
        robot=config["robot"],
        tasks=MULTIVERSE_TASK_FILES,
        published=PUBLISHED,
        modules=modules_of("explain_lag_rule"),
    output:
        "results/multiverse/lag_rule.nc",
    log:
        "results/logs/explain_lag_rule.log",
    params:
        settings={**MULTIVERSE_EXPERIMENT, **MULTIVERSE_DEFAULT, "replicates": 100},
    script:
        "../scripts/explain_lag_rule.py"


rule summarise_multiverse:
    input:
        scored="results/multiverse/readings.nc",
        influence="results/multiverse/influence.nc",
        choice="results/multiverse/choice.nc",
        mixture="results/multiverse/mixture.nc",
        lag_rule="results/multiverse/lag_rule.nc",
        modules=modules_of("summarise_multiverse"),
    output:
        "results/multiverse/chapter.json",
    log:
        "results/logs/summarise_multiverse.log",
    script:
        "../scripts/summarise_multiverse.py"


rule draw_multiverse:
    input:
        scored="results/multiverse/readings.nc",
        influence="results/multiverse/influence.nc",
        choice="results/multiverse/choice.nc",
        lag_rule="results/multiverse/lag_rule.nc",
        modules=modules_of("draw_multiverse"),
    output:
        "results/multiverse/figures/{picture}.svg",
    log:
        "results/logs/draw_multiverse/{picture}.log",
    script:
        "../scripts/draw_multiverse.py"
