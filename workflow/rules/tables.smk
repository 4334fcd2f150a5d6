rule tabulate_results:
    input:
        published=PUBLISHED,
        features=cells("features"),
        detections=cells("detection"),
        locations=cells("location"),
        modules=modules_of("tabulate_results"),
    output:
        **table_outputs(),
    log:
        "results/logs/tabulate_results.log",
    params:
        tables=REPORT_TABLES,
        replicate=config["report"]["replicate"],
    script:
        "../scripts/tabulate_results.py"
