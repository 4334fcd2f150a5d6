rule compute_trajectory:
    input:
        robot=config["robot"],
        task=task_file,
        modules=modules_of("compute_trajectory"),
    output:
        "results/trajectories/{task}.nc",
    log:
        "results/logs/compute_trajectory/{task}.log",
    script:
        "../scripts/compute_trajectory.py"
