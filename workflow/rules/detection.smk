DETECTION_READING = reading_of(config, "detection")


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


rule detect_wear:
    input:
        features="results/features/{task}/{run}.nc",
        model="results/detection/{task}/model.nc",
        modules=modules_of("detect_wear"),
    output:
        "results/detection/{task}/{run}.nc",
    log:
        "results/logs/detect_wear/{task}_{run}.log",
    params:
        settings={
            "consecutive_hours": config["detection"]["consecutive_hours"],
            "reading": {k: DETECTION_READING[k] for k in ("onset_rule", "pca_input")},
        },
    script:
        "../scripts/detect_wear.py"
