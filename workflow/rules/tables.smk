PUBLISHED = shipped("config/paper/published.yaml")


rule tabulate_lags:
    input:
        published=PUBLISHED,
        locations=cells("location"),
        modules=modules_of("tabulate_lags"),
    output:
        csv=report(
            "results/tables/table_ii.csv",
            caption="../../report/captions/table_ii.rst",
            category="Tables",
            labels={"table": "II", "form": "CSV"},
        ),
        netcdf=report(
            "results/tables/table_ii.nc",
            caption="../../report/captions/table_ii.rst",
            category="Tables",
            labels={"table": "II", "form": "netCDF"},
        ),
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
        csv=report(
            "results/tables/table_iii.csv",
            caption="../../report/captions/table_iii.rst",
            category="Tables",
            labels={"table": "III", "form": "CSV"},
        ),
        netcdf=report(
            "results/tables/table_iii.nc",
            caption="../../report/captions/table_iii.rst",
            category="Tables",
            labels={"table": "III", "form": "netCDF"},
        ),
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
        csv=report(
            "results/tables/table_iv.csv",
            caption="../../report/captions/table_iv.rst",
            category="Tables",
            labels={"table": "IV", "form": "CSV"},
        ),
        netcdf=report(
            "results/tables/table_iv.nc",
            caption="../../report/captions/table_iv.rst",
            category="Tables",
            labels={"table": "IV", "form": "netCDF"},
        ),
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
        csv=report(
            "results/tables/table_v.csv",
            caption="../../report/captions/table_v.rst",
            category="Tables",
            labels={"table": "V", "form": "CSV"},
        ),
        netcdf=report(
            "results/tables/table_v.nc",
            caption="../../report/captions/table_v.rst",
            category="Tables",
            labels={"table": "V", "form": "netCDF"},
        ),
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
        csv=report(
            "results/tables/table_vi.csv",
            caption="../../report/captions/table_vi.rst",
            category="Tables",
            labels={"table": "VI", "form": "CSV"},
        ),
        netcdf=report(
            "results/tables/table_vi.nc",
            caption="../../report/captions/table_vi.rst",
            category="Tables",
            labels={"table": "VI", "form": "netCDF"},
        ),
    log:
        "results/logs/tabulate_variation.log",
    script:
        "../scripts/tabulate_variation.py"
