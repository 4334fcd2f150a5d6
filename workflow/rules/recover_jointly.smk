# One experiment for the whole paper: arm, payload, wear shape, reading and poses fitted to everything that it prints.
JOINT_PARTS = 2
JOINT_CONTROLS = {"ours": 4, "known": 10, "shuffled": 10}
JOINT_SHARED = {
    "seed": config["seed"],
    "noise": config["noise"],
    "wear_hours": config["wear"]["hours"],
    "bins": config["histogram"]["bins"],
    "confidence": config["detection"]["confidence"],
    "variance_share": config["detection"]["variance_share"],
}
JOINT_KEPT = 30  # experiments that make the posterior
JOINT_FIGURES = ["cells", "frontier", "trade"]
STUDY_PICTURES["joint_fit"] = JOINT_FIGURES
STUDY_PICTURES["joint_fit_controls"] = ["controls"]


wildcard_constraints:
    joint_part="[0-9]+",
    joint_kind="|".join(JOINT_CONTROLS),
    joint_number="[0-9]+",
    joint_picture="|".join(JOINT_FIGURES),


rule recover_jointly:
    input:
        "results/joint_fit/chapter.json",
        "results/joint_fit/posterior.csv",
        "results/joint_fit/robot.yaml",
        "results/joint_fit/index.html",


rule check_joint_fit:
    input:
        "results/joint_fit_controls/chapter.json",
        "results/joint_fit_controls/index.html",


rule screen_joint_readings:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        modules=modules_of("screen_joint_readings"),
    output:
        "results/joint_fit/readings.nc",
    log:
        "results/logs/screen_joint_readings.log",
    params:
        settings={
            **JOINT_SHARED,
            "plan": {},
            "arms": 7,
            "fitted": 4,
            "screened": 3,
        },
    script:
        "../scripts/screen_joint_readings.py"


rule search_joint_poses:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        chosen="results/joint_fit/readings.nc",
        modules=modules_of("search_joint_poses"),
    output:
        "results/joint_fit/search/part_{joint_part}.nc",
    log:
        "results/logs/search_joint_poses/{joint_part}.log",
    params:
        part=lambda wildcards: int(wildcards.joint_part),
        settings={**JOINT_SHARED, "plan": {}, "parts": JOINT_PARTS, "kept": 5},
    script:
        "../scripts/search_joint_poses.py"


rule confirm_joint_fit:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        searched=expand(
            "results/joint_fit/search/part_{part}.nc", part=range(JOINT_PARTS)
        ),
        modules=modules_of("confirm_joint_fit"),
    output:
        "results/joint_fit/confirmed.nc",
    log:
        "results/logs/confirm_joint_fit.log",
    params:
        settings={**JOINT_SHARED, "confirm_replicates": 100},
    script:
        "../scripts/confirm_joint_fit.py"


rule trade_joint_aims:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        confirmed="results/joint_fit/confirmed.nc",
        modules=modules_of("trade_joint_aims"),
    output:
        "results/joint_fit/traded.nc",
    log:
        "results/logs/trade_joint_aims.log",
    params:
        settings={
            **JOINT_SHARED,
            "plan": {"members": 3},
            "arms": 2,
            # Factors on the weights of Tables V and VI, of the signs of Table II, and on the size of errors in Table V.
            "emphases": [
                [1, 1, 1],
                [1.5, 1, 1],
                [2.5, 1, 1],
                [1.5, 3, 1],
                [1, 3, 1],
                [1, 10, 1],
                [1, 1, 1.5],
                [1, 1, 2.5],
                [1.5, 1, 2],
            ],
            "confirm_replicates": 100,
        },
    script:
        "../scripts/trade_joint_aims.py"


rule control_joint_fit:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        modules=modules_of("control_joint_fit"),
    output:
        "results/joint_fit_controls/papers/{joint_kind}_{joint_number}.nc",
    log:
        "results/logs/control_joint_fit/{joint_kind}_{joint_number}.log",
    params:
        kind=lambda wildcards: wildcards.joint_kind,
        number=lambda wildcards: int(wildcards.joint_number),
        settings={
            **JOINT_SHARED,
            "fitted": 1,
            "confirm_replicates": 100,
            "plan": {
                "starts": 40,
                "keep": 12,
                "members": 4,
                "walk": 40,
                "local": {"rounds": 24},
            },
        },
    script:
        "../scripts/control_joint_fit.py"


rule write_joint_posterior:
    input:
        robot=UNLOADED,
        published=RECOVER_TABLES,
        confirmed="results/joint_fit/confirmed.nc",
        traded="results/joint_fit/traded.nc",
        modules=modules_of("write_joint_posterior"),
    output:
        table="results/joint_fit/posterior.csv",
        checked="results/joint_fit/checked.nc",
        robot="results/joint_fit/robot.yaml",
        tasks=expand("results/joint_fit/tasks/{name}.yaml", name=RECOVER_TASKS),
    log:
        "results/logs/write_joint_posterior.log",
    params:
        settings={
            **JOINT_SHARED,
            "sampling": config["sampling"],
            "normal_hours": config["normal"]["test_hours"],
            "reading": config["reading"],
            "check_replicates": 100,
            "kept": JOINT_KEPT,
        },
    script:
        "../scripts/write_joint_posterior.py"


rule summarise_joint_fit:
    input:
        limits=shipped("config/robots/puma560_paper.yaml"),
        published=RECOVER_TABLES,
        screened="results/joint_fit/readings.nc",
        confirmed="results/joint_fit/confirmed.nc",
        traded="results/joint_fit/traded.nc",
        checked="results/joint_fit/checked.nc",
        modules=modules_of("summarise_joint_fit"),
    output:
        "results/joint_fit/chapter.json",
    log:
        "results/logs/summarise_joint_fit.log",
    params:
        kept=JOINT_KEPT,
    script:
        "../scripts/summarise_joint_fit.py"


rule draw_joint_fit:
    input:
        chapter="results/joint_fit/chapter.json",
        modules=modules_of("draw_joint_fit"),
    output:
        "results/joint_fit/figures/{joint_picture}.svg",
    log:
        "results/logs/draw_joint_fit/{joint_picture}.log",
    script:
        "../scripts/draw_joint_fit.py"


rule summarise_joint_controls:
    input:
        papers=[
            f"results/joint_fit_controls/papers/{kind}_{number}.nc"
            for kind, count in JOINT_CONTROLS.items()
            for number in range(count)
        ],
        modules=modules_of("summarise_joint_controls"),
    output:
        "results/joint_fit_controls/chapter.json",
    log:
        "results/logs/summarise_joint_controls.log",
    script:
        "../scripts/summarise_joint_controls.py"


rule draw_joint_controls:
    input:
        chapter="results/joint_fit_controls/chapter.json",
        modules=modules_of("draw_joint_controls"),
    output:
        "results/joint_fit_controls/figures/controls.svg",
    log:
        "results/logs/draw_joint_controls.log",
    script:
        "../scripts/draw_joint_controls.py"
