# The static site: the report, every further page that has been built, data with checksums, an archive.
# Further pages are no inputs: the site shows what there is and never waits for a study.
rule write_site:
    input:
        page="results/report/index.html",
        templates=[
            *TEMPLATES,
            *templates("site.html.j2", "site_change.html.j2", "site_data.html.j2"),
        ],
        modules=modules_of("write_site"),
    output:
        directory("site"),
    log:
        "results/logs/write_site.log",
    params:
        # A page built, or built again, since the last time makes the site anew.
        pages=sorted(
            f"{path} {path.stat().st_mtime_ns}"
            for pattern in (
                "data/benchmarks/results.json",
                "results/*/*.html",
                "results/*/*/*.html",
            )
            for path in Path.cwd().glob(pattern)
            if path.parent.name != "report"
        ),
    script:
        "../scripts/write_site.py"
