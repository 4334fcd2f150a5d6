REPORT_FIGURES = [
    "figure_1",
    "figure_2",
    "figure_3",
    "figure_4",
    "table_ii",
    "table_iv",
]
TEMPLATES = [
    str(path)
    for pattern in (
        "report/base.html.j2",
        "report/index.html.j2",
        "report/macros.html.j2",
        "report/style.css",
        "report/chapters/*.html.j2",
        # The report quotes every ambiguity of the text, chosen or not.
        "workflow/jointwear/reproduction/readings/*.py",
    )
    for path in shipped_glob(pattern)
]
# Results of long studies, stored with the project: the report shows them without hours of computing (rules/studies.smk).
STUDIES = [path.parent for path in shipped_glob("data/studies/*/chapter.json")]
CHAPTERS = {folder.name: str(folder / "chapter.json") for folder in STUDIES}
CHAPTER_FIGURES = {
    f"{folder.name}_{path.stem}": str(path)
    for folder in STUDIES
    for path in sorted(folder.glob("*.svg"))
}

# One small data set with a hidden effect is part of every report.
SHOWN_DISCOVERY = f"results/discover/{SHOWN_DATASET}/chapter"
CHAPTERS["discover"] = f"{SHOWN_DISCOVERY}/chapter.json"
for picture in ("regimes", "effect", "gap", "where"):
    CHAPTER_FIGURES[f"discover_{picture}"] = f"{SHOWN_DISCOVERY}/{picture}.svg"


rule build_report:
    input:
        published=PUBLISHED,
        robot=config["robot"],
        tables=expand("results/tables/{table}.nc", table=REPORT_TABLES),
        spreadsheets=expand("results/tables/{table}.csv", table=REPORT_TABLES),
        figures=expand("results/figures/{figure}.svg", figure=REPORT_FIGURES),
        trajectories=TRAJECTORIES,
        simulations=cells("simulation"),
        detections=cells("detection"),
        locations=cells("location"),
        models=expand("results/detection/{task}/model.nc", task=config["tasks"]),
        tasks=[shipped(f"config/tasks/{task}.yaml") for task in config["tasks"]],
        training_features=expand(
            "results/features/{task}/training.nc", task=config["tasks"]
        ),
        training_simulations=expand(
            "results/simulation/{task}/training.nc", task=config["tasks"]
        ),
        normal_simulations=expand(
            "results/simulation/{task}/normal.nc", task=config["tasks"]
        ),
        normal_detections=expand(
            "results/detection/{task}/normal.nc", task=config["tasks"]
        ),
        normal_locations=expand(
            "results/location/{task}/normal.nc", task=config["tasks"]
        ),
        figure_run=[
            f"results/simulation/{FIGURE_RUN}",
            f"results/features/{FIGURE_RUN}",
            f"results/detection/{FIGURE_RUN}",
            shipped(f"config/tasks/{FIGURE_CELL.task}.yaml"),
        ],
        chapters=list(CHAPTERS.values()),
        chapter_figures=list(CHAPTER_FIGURES.values()),
        templates=TEMPLATES,
        modules=modules_of("build_report"),
    output:
        page=report(
            "results/report/index.html",
            caption="../../report/captions/page.rst",
            category="Report",
            labels={"page": "Whole report"},
        ),
        scores="results/report/summary.json",
    log:
        "results/logs/build_report.log",
    params:
        # The report prints the whole configuration of the reproduction.
        config={k: v for k, v in experiment_of(config).items() if k != "recover"},
        tables=REPORT_TABLES,
        figures=[*REPORT_FIGURES, *CHAPTER_FIGURES],
        figure_run=["simulation", "features", "detection", "task"],
        chapters=list(CHAPTERS),
    script:
        "../scripts/build_report.py"
