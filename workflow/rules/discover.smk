# Discovery: check -> nominal model -> where -> decide -> augmented robot -> simulate again -> gap -> page.
# A data set that is refused leaves refused.json and no verdict; run with --keep-going so that others go on.
from jointwear.running.datasets import check_datasets

try:
    check_datasets(config)
except InputError as error:
    sys.exit(f"jointwear: {error}")


wildcard_constraints:
    dataset="[A-Za-z][A-Za-z0-9_]*",


rule discover:
    input:
        expand("results/discover/{dataset}/verdict.json", dataset=CHOSEN_DATASETS),
        expand("results/discover/{dataset}/discover.html", dataset=CHOSEN_DATASETS),


rule ingest_recording:
    input:
        measured=lambda wildcards: DATASETS[wildcards.dataset]["measured"],
        robot=dataset_robot,
        model=dataset_model,
        modules=modules_of("ingest_recording"),
    output:
        "results/discover/{dataset}/recording.nc",
    log:
        "results/logs/ingest_recording/{dataset}.log",
    params:
        entry=dataset_entry,
    script:
        "../scripts/ingest_recording.py"


rule compare_nominal:
    input:
        recording="results/discover/{dataset}/recording.nc",
        robot=dataset_robot,
        model=dataset_model,
        modules=modules_of("compare_nominal"),
    output:
        "results/discover/{dataset}/nominal.nc",
    log:
        "results/logs/compare_nominal/{dataset}.log",
    script:
        "../scripts/compare_nominal.py"


rule locate_discrepancy:
    input:
        recording="results/discover/{dataset}/recording.nc",
        robot=dataset_robot,
        model=dataset_model,
        modules=modules_of("locate_discrepancy"),
    output:
        "results/discover/{dataset}/where.nc",
    log:
        "results/logs/locate_discrepancy/{dataset}.log",
    params:
        entry=dataset_entry,
    script:
        "../scripts/locate_discrepancy.py"


rule decide_effects:
    input:
        recording="results/discover/{dataset}/recording.nc",
        robot=dataset_robot,
        model=dataset_model,
        modules=modules_of("decide_effects"),
    output:
        decision="results/discover/{dataset}/decision.json",
        robot="results/discover/{dataset}/robot.yaml",
        retuned="results/discover/{dataset}/retuned.yaml",
        evidence="results/discover/{dataset}/evidence.nc",
    log:
        "results/logs/decide_effects/{dataset}.log",
    params:
        entry=dataset_entry,
    script:
        "../scripts/decide_effects.py"


rule simulate_models:
    input:
        nominal="results/discover/{dataset}/nominal.nc",
        recording="results/discover/{dataset}/recording.nc",
        robot="results/discover/{dataset}/robot.yaml",
        retuned="results/discover/{dataset}/retuned.yaml",
        modules=modules_of("simulate_models"),
    output:
        "results/discover/{dataset}/models.nc",
    log:
        "results/logs/simulate_models/{dataset}.log",
    script:
        "../scripts/simulate_models.py"


rule measure_gap:
    input:
        decision="results/discover/{dataset}/decision.json",
        models="results/discover/{dataset}/models.nc",
        recording="results/discover/{dataset}/recording.nc",
        modules=modules_of("measure_gap"),
    output:
        "results/discover/{dataset}/verdict.json",
    log:
        "results/logs/measure_gap/{dataset}.log",
    script:
        "../scripts/measure_gap.py"


rule report_discovery:
    input:
        verdict="results/discover/{dataset}/verdict.json",
        where="results/discover/{dataset}/where.nc",
        models="results/discover/{dataset}/models.nc",
        published=published_values,
        templates=templates("discover.html.j2"),
        modules=modules_of("report_discovery"),
    output:
        page="results/discover/{dataset}/discover.html",
        figures=directory("results/discover/{dataset}/figures"),
    log:
        "results/logs/report_discovery/{dataset}.log",
    script:
        "../scripts/report_discovery.py"


rule summarise_discovery:
    input:
        verdict=f"results/discover/{SHOWN_DATASET}/verdict.json",
        where=f"results/discover/{SHOWN_DATASET}/where.nc",
        models=f"results/discover/{SHOWN_DATASET}/models.nc",
        modules=modules_of("summarise_discovery"),
    output:
        chapter=f"results/discover/{SHOWN_DATASET}/chapter/chapter.json",
        where=f"results/discover/{SHOWN_DATASET}/chapter/where.svg",
        effect=f"results/discover/{SHOWN_DATASET}/chapter/effect.svg",
        gap=f"results/discover/{SHOWN_DATASET}/chapter/gap.svg",
    log:
        "results/logs/summarise_discovery.log",
    script:
        "../scripts/summarise_discovery.py"
