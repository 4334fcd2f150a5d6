# The paper beside two experiments: its text taken at its word, and the closest of the joint fit. Each runs through the
# stages of the reproduction in a working directory of its own, as a user's experiment would.
BESIDE = {name: f"results/side_by_side/{name}" for name in ("literal", "closest")}
BESIDE_TABLES = ["table_ii", "table_iv", "table_v", "table_vi"]
# The stages behind these tables.
BESIDE_STAGES = [
    "simulate_training",
    "simulate_wear",
    "build_reference",
    "compute_features",
    "fit_normal_model",
    "diagnose_run",
    "tabulate_results",
]
# What lies under a config of these directories, and what the literal experiment has of it; the closest has its own.
BESIDE_SHIPPED = ["config/config.yaml", "config/paper/published.yaml"]
LITERAL_SHIPPED = [
    "config/robots/puma560_paper.yaml",
    *[f"config/tasks/{name}.yaml" for name in RECOVER_TASKS],
]
STUDY_PICTURES["side_by_side"] = ["hours"]


wildcard_constraints:
    beside="|".join(BESIDE),


rule compare_experiments:
    input:
        "results/side_by_side/chapter.json",
        "results/side_by_side/index.html",


rule write_literal:
    input:
        shipped("config/examples/literal.yaml"),
    output:
        "results/side_by_side/literal/config/config.yaml",
    log:
        "results/logs/write_literal.log",
    shell:
        "cp {input} {output} 2> {log}"


rule write_closest:
    input:
        checked="results/joint_fit/checked.nc",
        robot="results/joint_fit/robot.yaml",
        tasks=expand("results/joint_fit/tasks/{name}.yaml", name=RECOVER_TASKS),
        modules=modules_of("write_closest"),
    output:
        "results/side_by_side/closest/config/config.yaml",
    log:
        "results/logs/write_closest.log",
    params:
        reading=config["reading"],
    script:
        "../scripts/write_closest.py"


rule tabulate_beside:
    input:
        config="results/side_by_side/{beside}/config/config.yaml",
        shipped=lambda wildcards: [
            from_here(LIBRARY.parent / path)
            for path in (
                *BESIDE_SHIPPED,
                *(LITERAL_SHIPPED if wildcards.beside == "literal" else ()),
            )
        ],
        modules=lambda wildcards: sorted(
            {path for stage in BESIDE_STAGES for path in modules_of(stage)(wildcards)}
        ),
    output:
        expand(
            "results/side_by_side/{{beside}}/results/tables/{table}.nc",
            table=BESIDE_TABLES,
        ),
    log:
        "results/logs/tabulate_beside/{beside}.log",
    threads: 2
    params:
        python=sys.executable,
        snakefile=LIBRARY.parent / "Snakefile",
        folder=lambda wildcards: BESIDE[wildcards.beside],
        tables=[f"results/tables/{table}.nc" for table in BESIDE_TABLES],
    shell:
        "{params.python} -m snakemake -s {params.snakefile} --directory {params.folder} --cores {threads}"
        " {params.tables} > {log} 2>&1"


rule summarise_side_by_side:
    input:
        [
            f"{folder}/results/tables/{table}.nc"
            for folder in BESIDE.values()
            for table in BESIDE_TABLES
        ],
        modules=modules_of("summarise_side_by_side"),
    output:
        "results/side_by_side/chapter.json",
    log:
        "results/logs/summarise_side_by_side.log",
    params:
        folders=BESIDE,
    script:
        "../scripts/summarise_side_by_side.py"


rule draw_side_by_side:
    input:
        chapter="results/side_by_side/chapter.json",
        modules=modules_of("draw_side_by_side"),
    output:
        "results/side_by_side/figures/hours.svg",
    log:
        "results/logs/draw_side_by_side.log",
    script:
        "../scripts/draw_side_by_side.py"
