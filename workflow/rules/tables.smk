PUBLISHED = "config/paper/published.yaml"


rule tabulate_lags:
    input:
        published=PUBLISHED,
        locations=cells("location"),
        modules=modules_of("tabulate_lags"),
    output:
        csv="results/tables/table_ii.csv",
        netcdf="results/tables/table_ii.nc",
    log:
        "results/logs/tabulate_lags.log",
    params:
        replicate=config["report"]["replicate"],
    script:
        "../scripts/tabulate_lags.py"


rule tabulate_design:
    input:
        published=PUBLISHED,
        detections=cells("detection"),
        modules=modules_of("tabulate_design"),
    output:
        csv="results/tables/table_iii.csv",
        netcdf="results/tables/table_iii.nc",
    log:
        "results/logs/tabulate_design.log",
    script:
        "../scripts/tabulate_design.py"


rule tabulate_detection:
    input:
        published=PUBLISHED,
        detections=cells("detection"),
        locations=cells("location"),
        modules=modules_of("tabulate_detection"),
    output:
        csv="results/tables/table_iv.csv",
        netcdf="results/tables/table_iv.nc",
    log:
        "results/logs/tabulate_detection.log",
    script:
        "../scripts/tabulate_detection.py"


rule tabulate_torque:
    input:
        published=PUBLISHED,
        features=cells("features"),
        detections=cells("detection"),
        modules=modules_of("tabulate_torque"),
    output:
        csv="results/tables/table_v.csv",
        netcdf="results/tables/table_v.nc",
    log:
        "results/logs/tabulate_torque.log",
    script:
        "../scripts/tabulate_torque.py"


rule tabulate_variation:
    input:
        published=PUBLISHED,
        features=cells("features"),
        detections=cells("detection"),
        modules=modules_of("tabulate_variation"),
    output:
        csv="results/tables/table_vi.csv",
        netcdf="results/tables/table_vi.nc",
    log:
        "results/logs/tabulate_variation.log",
    script:
        "../scripts/tabulate_variation.py"
