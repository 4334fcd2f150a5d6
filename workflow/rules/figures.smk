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


rule draw_figures:
    input:
        simulation=f"results/simulation/{FIGURE_RUN}",
        features=f"results/features/{FIGURE_RUN}",
        model=f"results/detection/{FIGURE_CELL.task}/model.nc",
        detection=f"results/detection/{FIGURE_RUN}",
        trajectories=TRAJECTORIES,
        robot=config["robot"],
        task=shipped(f"config/tasks/{FIGURE_CELL.task}.yaml"),
        published=PUBLISHED,
        modules=modules_of("draw_figures"),
    output:
        figure_1=drawn("figure_1", "figure_1", "1"),
        figure_2=drawn("figure_2", "figure_2", "2"),
        figure_3=drawn("figure_3", "figure_3", "3"),
        figure_4=drawn("figure_4", "figure_4", "4"),
    log:
        "results/logs/draw_figures.log",
    params:
        replicate=config["report"]["replicate"],
        confidence=config["detection"]["confidence"],
    script:
        "../scripts/draw_figures.py"


rule draw_maps:
    input:
        lags="results/tables/table_ii.nc",
        detection="results/tables/table_iv.nc",
        modules=modules_of("draw_maps"),
    output:
        lags=drawn("table_ii", "map_ii", "Lags (Table II)"),
        detection=drawn("table_iv", "map_iv", "Detection (Table IV)"),
    log:
        "results/logs/draw_maps.log",
    params:
        replicate=config["report"]["replicate"],
    script:
        "../scripts/draw_maps.py"
