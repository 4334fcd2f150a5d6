# A robot's own model from the logs of its baseline: made by this target alone, used by `monitor` and `fleet` wherever it
# is there. Its robot.yaml is no output on purpose: a new day of logs must not learn what is normal anew.
LEARNT_KEYS = (*READING_KEYS, "logs", "robot", "baseline")


rule learn_normal:
    input:
        of_chosen_robots("results/learned/{monitored}/learned.json"),


rule learn_robot:
    input:
        model=lambda wildcards: robot_sources(given_entry(wildcards)["robot"]),
        modules=modules_of("learn_normal"),
    output:
        learned="results/learned/{monitored}/learned.json",
        verdict="results/learned/{monitored}/verdict.json",
    log:
        "results/logs/learn_normal/{monitored}.log",
    params:
        entry=lambda wildcards: {
            key: value
            for key, value in given_entry(wildcards).items()
            if key in LEARNT_KEYS
        },
    script:
        "../scripts/learn_normal.py"
