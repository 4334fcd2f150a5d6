from jointwear.publishing.figures.cells import figure_cell
from jointwear.reproduction.published import load_published

# Figures 1 to 3 show the run of Table II: axis 1, 10 %. The paper names no task for them, and no axis for Figure 3.
FIGURE_CELL = figure_cell(
    load_published(PUBLISHED).lag_cell,
    config["tasks"],
    config["wear"]["axes"],
    config["wear"]["increase_percent"],
)
FIGURE_RUN = f"{FIGURE_CELL.task}/axis{FIGURE_CELL.axis}_{percent(FIGURE_CELL.increase_percent)}percent.nc"
TRAJECTORIES = expand("results/trajectories/{task}.nc", task=config["tasks"])


rule draw_figure_1:
    input:
        simulation=f"results/simulation/{FIGURE_RUN}",
        robot=config["robot"],
        task=shipped(f"config/tasks/{FIGURE_CELL.task}.yaml"),
        published=PUBLISHED,
        modules=modules_of("draw_figure_1"),
    output:
        report(
            "results/figures/figure_1.svg",
            caption="../../report/captions/figure_1.rst",
            category="Figures",
            labels={"figure": "1"},
        ),
    log:
        "results/logs/draw_figure_1.log",
    params:
        replicate=config["report"]["replicate"],
    script:
        "../scripts/draw_figure_1.py"


rule draw_figure_2:
    input:
        features=f"results/features/{FIGURE_RUN}",
        published=PUBLISHED,
        modules=modules_of("draw_figure_2"),
    output:
        report(
            "results/figures/figure_2.svg",
            caption="../../report/captions/figure_2.rst",
            category="Figures",
            labels={"figure": "2"},
        ),
    log:
        "results/logs/draw_figure_2.log",
    params:
        replicate=config["report"]["replicate"],
    script:
        "../scripts/draw_figure_2.py"


rule draw_figure_3:
    input:
        model=f"results/detection/{FIGURE_CELL.task}/model.nc",
        detection=f"results/detection/{FIGURE_RUN}",
        published=PUBLISHED,
        modules=modules_of("draw_figure_3"),
    output:
        report(
            "results/figures/figure_3.svg",
            caption="../../report/captions/figure_3.rst",
            category="Figures",
            labels={"figure": "3"},
        ),
    log:
        "results/logs/draw_figure_3.log",
    params:
        replicate=config["report"]["replicate"],
        confidence=config["detection"]["confidence"],
    script:
        "../scripts/draw_figure_3.py"


rule draw_figure_4:
    input:
        trajectories=TRAJECTORIES,
        published=PUBLISHED,
        modules=modules_of("draw_figure_4"),
    output:
        report(
            "results/figures/figure_4.svg",
            caption="../../report/captions/figure_4.rst",
            category="Figures",
            labels={"figure": "4"},
        ),
    log:
        "results/logs/draw_figure_4.log",
    script:
        "../scripts/draw_figure_4.py"


rule draw_lag_map:
    input:
        table="results/tables/table_ii.csv",
        modules=modules_of("draw_lag_map"),
    output:
        report(
            "results/figures/table_ii.svg",
            caption="../../report/captions/map_ii.rst",
            category="Figures",
            labels={"figure": "Lags (Table II)"},
        ),
    log:
        "results/logs/draw_lag_map.log",
    params:
        replicate=config["report"]["replicate"],
    script:
        "../scripts/draw_lag_map.py"


rule draw_detection_map:
    input:
        table="results/tables/table_iv.csv",
        modules=modules_of("draw_detection_map"),
    output:
        report(
            "results/figures/table_iv.svg",
            caption="../../report/captions/map_iv.rst",
            category="Figures",
            labels={"figure": "Detection (Table IV)"},
        ),
    log:
        "results/logs/draw_detection_map.log",
    script:
        "../scripts/draw_detection_map.py"
