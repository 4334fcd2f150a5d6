# What the paper left out: bound, fits of all candidates, transfer test, pose sets, verdict (docs: recovery).
from jointwear.studies.recovery.plan import CAUSES, candidate_names

UNLOADED = config["recover"]["robot"]
RECOVER_TABLES = shipped("config/paper/published.yaml")
RECOVER_TASKS = ["T1", "T2", "T3"]  # the tasks that the paper tabulates
RECOVER_SHARED = {
    "seed": config["seed"],
    "comparison": config["recover"]["comparison"],
}
CANDIDATE_FITS = [f"results/recovery/fits/{name}.nc" for name in candidate_names()]
VALIDATION_CASES = [
    f"results/recovery/validation/{cause}_{number}.nc"
    for cause in CAUSES
    for number in range(config["recover"]["validation"]["cases"])
]

RECOVER_PICTURES = ["bound", "payload", "candidates", "ensemble", "prediction"]
RECOVERED_EXPERIMENT = [
    "results/recovery/robot.yaml",
    *expand("results/recovery/tasks/{name}.yaml", name=RECOVER_TASKS),
]
ADOPTED_EXPERIMENT = [
    shipped("config/robots/puma560_paper.yaml"),
    *[shipped(f"config/tasks/{name}.yaml") for name in RECOVER_TASKS],
]
STUDY_PICTURES["recovery"] = RECOVER_PICTURES
STUDY_PICTURES["recovery_validation"] = ["named"]


wildcard_constraints:
    recovery_picture="|".join(RECOVER_PICTURES),
    candidate="[a-z_+]+",
    cause="|".join(CAUSES),
    number="[0-9]+",
    hours_used="published|unknown",


rule recover:
    input:
        "results/recovery/bound.nc",
        "results/recovery/verdict.json",
        "results/recovery/comparison.csv",
        RECOVERED_EXPERIMENT,
        "results/recovery/wear.yaml",
        "results/recovery/prediction.nc",
        "results/recovery/index.html",


rule recover_validation:
    input:
        "results/recovery/validation.nc",
        "results/recovery_validation/index.html",


rule bound_torque:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        modules=modules_of("bound_torque"),
    output:
        "results/recovery/bound.nc",
    log:
        "results/logs/bound_torque.log",
    params:
        settings={
            "seed": config["seed"],
            "segment_times": config["recover"]["bound"]["segment_times"],
            "noise_allowance": config["recover"]["bound"]["noise_allowance"],
        },
    script:
        "../scripts/bound_torque.py"


rule fit_candidate:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        simpler=lambda wildcards: [
            f"results/recovery/fits/{part}.nc"
            for part in wildcards.candidate.split("+")
            if "+" in wildcards.candidate
        ],
        modules=modules_of("fit_candidate"),
    output:
        "results/recovery/fits/{candidate}.nc",
    log:
        "results/logs/fit_candidate/{candidate}.log",
    params:
        settings={**RECOVER_SHARED, "search": config["recover"]["search"]},
    script:
        "../scripts/fit_candidate.py"


rule test_transfer:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        fits=CANDIDATE_FITS,
        modules=modules_of("test_transfer"),
    output:
        "results/recovery/transfer.nc",
    log:
        "results/logs/test_transfer.log",
    params:
        settings={**RECOVER_SHARED, "transfer": config["recover"]["transfer"]},
    script:
        "../scripts/test_transfer.py"


rule collect_solutions:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        fit="results/recovery/fits/payload.nc",
        modules=modules_of("collect_solutions"),
    output:
        "results/recovery/ensemble_{hours_used}_hours.nc",
    log:
        "results/logs/collect_solutions/{hours_used}.log",
    params:
        settings=lambda wildcards: {
            **RECOVER_SHARED,
            "solutions": config["recover"]["solutions"],
            "tolerance": config["recover"]["tolerance"],
            "hours": wildcards.hours_used,
        },
    script:
        "../scripts/collect_solutions.py"


rule judge_candidates:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        fits=CANDIDATE_FITS,
        transfer="results/recovery/transfer.nc",
        ensemble="results/recovery/ensemble_published_hours.nc",
        modules=modules_of("judge_candidates"),
    output:
        verdict="results/recovery/verdict.json",
        comparison="results/recovery/comparison.csv",
    log:
        "results/logs/judge_candidates.log",
    script:
        "../scripts/judge_candidates.py"


rule export_experiment:
    input:
        robot=UNLOADED,
        ensemble="results/recovery/ensemble_published_hours.nc",
        modules=modules_of("export_experiment"),
    output:
        robot="results/recovery/robot.yaml",
        tasks=expand("results/recovery/tasks/{name}.yaml", name=RECOVER_TASKS),
        wear="results/recovery/wear.yaml",
    log:
        "results/logs/export_experiment.log",
    script:
        "../scripts/export_experiment.py"


rule predict_detection:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        ensemble="results/recovery/ensemble_unknown_hours.nc",
        modules=modules_of("predict_detection"),
    output:
        "results/recovery/prediction.nc",
    log:
        "results/logs/predict_detection.log",
    params:
        settings={
            "seed": config["seed"],
            **config["recover"]["prediction"],
            "noise": config["noise"],
            "reading": reading_of(config, "simulation", "features", "detection"),
            "bins": config["histogram"]["bins"],
            "confidence": config["detection"]["confidence"],
            "variance_share": config["detection"]["variance_share"],
            "consecutive_hours": config["detection"]["consecutive_hours"],
        },
    script:
        "../scripts/predict_detection.py"


rule validate_recovery:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        modules=modules_of("validate_recovery"),
    output:
        "results/recovery/validation/{cause}_{number}.nc",
    log:
        "results/logs/validate_recovery/{cause}_{number}.log",
    params:
        settings={
            **RECOVER_SHARED,
            "search": config["recover"]["validation"]["search"],
        },
    script:
        "../scripts/validate_recovery.py"


rule summarise_validation:
    input:
        cases=VALIDATION_CASES,
        modules=modules_of("summarise_validation"),
    output:
        netcdf="results/recovery/validation.nc",
        chapter="results/recovery_validation/chapter.json",
    log:
        "results/logs/summarise_validation.log",
    script:
        "../scripts/summarise_validation.py"


rule draw_validation:
    input:
        chapter="results/recovery_validation/chapter.json",
        modules=modules_of("draw_validation"),
    output:
        "results/recovery_validation/figures/named.svg",
    log:
        "results/logs/draw_validation.log",
    script:
        "../scripts/draw_validation.py"


rule summarise_recovery:
    input:
        bound="results/recovery/bound.nc",
        verdict="results/recovery/verdict.json",
        comparison="results/recovery/comparison.csv",
        transfer="results/recovery/transfer.nc",
        ensemble="results/recovery/ensemble_published_hours.nc",
        prediction="results/recovery/prediction.nc",
        modules=modules_of("summarise_recovery"),
    output:
        "results/recovery/chapter.json",
    log:
        "results/logs/summarise_recovery.log",
    script:
        "../scripts/summarise_recovery.py"


rule draw_recovery:
    input:
        chapter="results/recovery/chapter.json",
        modules=modules_of("draw_recovery"),
    output:
        "results/recovery/figures/{recovery_picture}.svg",
    log:
        "results/logs/draw_recovery/{recovery_picture}.log",
    script:
        "../scripts/draw_recovery.py"


# What was recovered becomes the default experiment: the only rule that writes into config/.
rule adopt_recovered:
    input:
        robot="results/recovery/robot.yaml",
        tasks=expand("results/recovery/tasks/{name}.yaml", name=RECOVER_TASKS),
        wear="results/recovery/wear.yaml",
        place=checkout_alone("adopt_recovered", "renews files of the checkout"),
        modules=modules_of("adopt_recovered"),
    output:
        touch("results/recovery/adopted"),
    log:
        "results/logs/adopt_recovered.log",
    params:
        robot=ADOPTED_EXPERIMENT[0],
        tasks=ADOPTED_EXPERIMENT[1:],
        config=shipped("config/config.yaml"),
    script:
        "../scripts/adopt_recovered.py"


rule check_recovered:
    input:
        recovered=RECOVERED_EXPERIMENT,
        copies=ADOPTED_EXPERIMENT,
        modules=modules_of("check_recovered"),
    output:
        "results/recovery/copies.csv",
    log:
        "results/logs/check_recovered.log",
    params:
        tolerance=0.02,
    script:
        "../scripts/check_recovered.py"
