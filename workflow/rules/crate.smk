# The run of the default report as a Workflow Run RO-Crate (needs requirements/publish.txt: `make crate`).
rule write_crate:
    input:
        page="results/report/index.html",
        place=checkout_alone("write_crate", "packs the checkout with its results"),
        modules=modules_of("write_crate"),
    output:
        directory("crate"),
    log:
        "results/logs/write_crate.log",
    params:
        config=experiment_of(config),
    script:
        "../scripts/write_crate.py"
