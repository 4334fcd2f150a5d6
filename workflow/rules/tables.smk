PUBLISHED = shipped("config/paper/published.yaml")
REPORT_TABLES = ["table_ii", "table_iii", "table_iv", "table_v", "table_vi"]


def table_outputs():
    """The CSV and netCDF file of every table, labelled for Snakemake's own report."""
    return {
        f"{table}_{kind}": report(
            f"results/tables/{table}.{ending}",
            caption=f"../../report/captions/{table}.rst",
            category="Tables",
            labels={"table": table.removeprefix("table_").upper(), "form": form},
        )
        for table in REPORT_TABLES
        for kind, ending, form in (("csv", "csv", "CSV"), ("netcdf", "nc", "netCDF"))
    }


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
        folder="results/tables",
        replicate=config["report"]["replicate"],
    script:
        "../scripts/tabulate_results.py"
