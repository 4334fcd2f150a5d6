# What the tables and figures of the report are, and how Snakemake's own report labels them.
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


def drawn(name, caption, label):
    """One figure, labelled for Snakemake's own report."""
    return report(
        f"results/figures/{name}.svg",
        caption=f"../../report/captions/{caption}.rst",
        category="Figures",
        labels={"figure": label},
    )
