# A simulated shop floor that scores the monitor: false alarms before any wear, worn axes found, forecasts.
from jointwear.studies.shop_floor.plan import batches as shop_batches

SHOP_FIGURES = ["false_alarms", "found"]
STUDY_PICTURES["shop_floor"] = SHOP_FIGURES


wildcard_constraints:
    shop_seeds="choose|report",
    shop_batch="[0-9]{3}",


rule shop_floor:
    input:
        "results/shop_floor/chapter.json",
        "results/shop_floor/index.html",


rule simulate_shop_floor:
    input:
        modules=modules_of("simulate_shop_floor"),
    output:
        directory("results/shop_floor/{shop_seeds}/windows/{shop_batch}"),
    log:
        "results/logs/simulate_shop_floor/{shop_seeds}_{shop_batch}.log",
    script:
        "../scripts/simulate_shop_floor.py"


rule judge_shop_floor:
    input:
        windows="results/shop_floor/{shop_seeds}/windows/{shop_batch}",
        modules=modules_of("judge_shop_floor"),
    output:
        "results/shop_floor/{shop_seeds}/outcomes/{shop_batch}.json",
    log:
        "results/logs/judge_shop_floor/{shop_seeds}_{shop_batch}.log",
    script:
        "../scripts/judge_shop_floor.py"


# The judgement that users call on the paper's grid too: the study of the monitor has its estimates, not its decision.
rule judge_paper_grid:
    input:
        robot=config["robot"],
        task=task_file,
        runs=runs_of("simulation", "training", "normal"),
        modules=modules_of("judge_paper_grid"),
    output:
        "results/shop_floor/paper_grid/{task}.json",
    log:
        "results/logs/judge_paper_grid/{task}.log",
    params:
        settings={
            "interval": config["sampling"]["interval"],
            "samples": config["sampling"]["samples"],
        },
    script:
        "../scripts/judge_paper_grid.py"


rule summarise_shop_floor:
    input:
        outcomes=expand(
            "results/shop_floor/report/outcomes/{shop_batch}.json",
            shop_batch=shop_batches(),
        ),
        before=shipped("data/studies/shop_floor/before.json"),
        grid=expand("results/shop_floor/paper_grid/{task}.json", task=config["tasks"]),
        modules=modules_of("summarise_shop_floor"),
    output:
        "results/shop_floor/chapter.json",
    log:
        "results/logs/summarise_shop_floor.log",
    params:
        tasks=config["tasks"],
    script:
        "../scripts/summarise_shop_floor.py"


rule draw_shop_floor:
    input:
        chapter="results/shop_floor/chapter.json",
        modules=modules_of("draw_shop_floor"),
    output:
        "results/shop_floor/figures/{drawing}.svg",
    log:
        "results/logs/draw_shop_floor/{drawing}.log",
    wildcard_constraints:
        drawing="|".join(SHOP_FIGURES),
    script:
        "../scripts/draw_shop_floor.py"
