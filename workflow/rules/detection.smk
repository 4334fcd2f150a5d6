DETECTION_READING = reading_of(config, "detection")
# Of these, what a normal model depends on when its series are chosen.
MODEL_READING = {
    k: v for k, v in DETECTION_READING.items() if k not in ("onset_rule", "pca_input")
}


rule fit_normal_model:
    input:
        features="results/features/{task}/training.nc",
        modules=modules_of("fit_normal_model"),
    output:
        "results/detection/{task}/model.nc",
    log:
        "results/logs/fit_normal_model/{task}.log",
    params:
        settings={
            "confidence": config["detection"]["confidence"],
            "variance_share": config["detection"]["variance_share"],
            "reading": {
                k: v for k, v in DETECTION_READING.items() if k != "onset_rule"
            },
        },
    script:
        "../scripts/fit_normal_model.py"


# Detection and location of one run share a job: each takes less time than starting it.
rule diagnose_run:
    input:
        features="results/features/{task}/{run}.nc",
        training="results/features/{task}/training.nc",
        model="results/detection/{task}/model.nc",
        modules=modules_of("diagnose_run"),
    output:
        detection="results/detection/{task}/{run}.nc",
        location="results/location/{task}/{run}.nc",
    log:
        "results/logs/diagnose_run/{task}_{run}.log",
    params:
        detection={
            "consecutive_hours": config["detection"]["consecutive_hours"],
            "reading": {k: DETECTION_READING[k] for k in ("onset_rule", "pca_input")},
        },
        location={"reading": reading_of(config, "location")},
    script:
        "../scripts/diagnose_run.py"
