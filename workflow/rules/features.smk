FEATURE_SETTINGS = {
    "bins": config["histogram"]["bins"],
    "reading": reading_of(config, "features"),
}


rule build_reference:
    input:
        torque="results/simulation/{task}/training.nc",
        modules=modules_of("build_reference"),
    output:
        "results/features/{task}/reference.nc",
    log:
        "results/logs/build_reference/{task}.log",
    params:
        settings=FEATURE_SETTINGS,
    script:
        "../scripts/build_reference.py"


rule compute_features:
    input:
        torque="results/simulation/{task}/{run}.nc",
        reference="results/features/{task}/reference.nc",
        modules=modules_of("compute_features"),
    output:
        "results/features/{task}/{run}.nc",
    log:
        "results/logs/compute_features/{task}_{run}.log",
    params:
        settings=FEATURE_SETTINGS,
    script:
        "../scripts/compute_features.py"
