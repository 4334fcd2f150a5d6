rule simulate_training:
    input:
        robot=config["robot"],
        task=task_file,
        modules=simulation_modules("simulate_training"),
    output:
        "results/simulation/{task}/training.nc",
    log:
        "results/logs/simulate_training/{task}.log",
    params:
        settings=simulation_settings(),
        length=reading_of(config, "training")["training_length"],
    script:
        "../scripts/simulate_training.py"


rule simulate_normal:
    input:
        robot=config["robot"],
        task=task_file,
        modules=simulation_modules("simulate_normal"),
    output:
        "results/simulation/{task}/normal.nc",
    log:
        "results/logs/simulate_normal/{task}.log",
    params:
        settings=simulation_settings(),
        hours=config["normal"]["test_hours"],
    script:
        "../scripts/simulate_normal.py"


rule simulate_wear:
    input:
        robot=config["robot"],
        task=task_file,
        modules=simulation_modules("simulate_wear"),
    output:
        "results/simulation/{task}/axis{axis}_{increase}percent.nc",
    log:
        "results/logs/simulate_wear/{task}_axis{axis}_{increase}percent.log",
    params:
        settings=simulation_settings(
            shape=config["wear"]["shape"], wear_hours=config["wear"]["hours"]
        ),
    script:
        "../scripts/simulate_wear.py"
