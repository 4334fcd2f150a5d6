# Discovery: one job finds what a model lacks and writes every file, one draws the page, one the report's chapter.
# A data set that is refused leaves refused.json and no verdict; others go on, as the profile says --keep-going.
from jointwear.running.datasets import check_datasets

try:
    check_datasets(config)
except InputError as error:
    sys.exit(told(error))


# Only data sets of the config and of the examples are made; a robot file of any other is taken as it is.
wildcard_constraints:
    dataset="|".join(DATASETS) or "none",


rule discover:
    input:
        of_chosen_datasets("results/discover/{dataset}/check.html"),
        of_chosen_datasets("results/discover/{dataset}/verdict.json"),
        of_chosen_datasets("results/discover/{dataset}/discover.html"),


rule check_data:
    input:
        of_chosen_datasets("results/discover/{dataset}/check.html"),


rule check_dataset:
    input:
        measured=dataset_measured,
        robot=dataset_robot,
        model=dataset_model,
        templates=templates("check.html.j2"),
        modules=modules_of("check_dataset"),
    output:
        check="results/discover/{dataset}/check.json",
        page="results/discover/{dataset}/check.html",
    log:
        "results/logs/check_dataset/{dataset}.log",
    params:
        entry=dataset_entry,
    script:
        "../scripts/check_dataset.py"


rule discover_dataset:
    input:
        measured=dataset_measured,
        robot=dataset_robot,
        model=dataset_model,
        modules=modules_of("discover_dataset"),
    output:
        verdict="results/discover/{dataset}/verdict.json",
        robot="results/discover/{dataset}/robot.yaml",
        retuned="results/discover/{dataset}/retuned.yaml",
        recording="results/discover/{dataset}/recording.nc",
        models="results/discover/{dataset}/models.nc",
        where="results/discover/{dataset}/where.nc",
        evidence="results/discover/{dataset}/evidence.nc",
    log:
        "results/logs/discover_dataset/{dataset}.log",
    params:
        entry=dataset_entry,
    script:
        "../scripts/discover_dataset.py"


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
        regimes=f"results/discover/{SHOWN_DATASET}/chapter/regimes.svg",
        where=f"results/discover/{SHOWN_DATASET}/chapter/where.svg",
        effect=f"results/discover/{SHOWN_DATASET}/chapter/effect.svg",
        gap=f"results/discover/{SHOWN_DATASET}/chapter/gap.svg",
    log:
        "results/logs/summarise_discovery.log",
    script:
        "../scripts/summarise_discovery.py"
