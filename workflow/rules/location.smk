rule locate_wear:
    input:
        features="results/features/{task}/{run}.nc",
        training="results/features/{task}/training.nc",
        detection="results/detection/{task}/{run}.nc",
        modules=modules_of("locate_wear"),
    output:
        "results/location/{task}/{run}.nc",
    log:
        "results/logs/locate_wear/{task}_{run}.log",
    params:
        settings={"reading": reading_of(config, "location")},
    script:
        "../scripts/locate_wear.py"
