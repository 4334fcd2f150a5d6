# Compute the run of a crate again and compare file by file; fails if a file differs.
rule verify:
    input:
        modules=modules_of("verify"),
    log:
        "results/logs/verify.log",
    threads: CORES or 1
    params:
        crate=CRATE,
        trust=TRUST,
    script:
        "../scripts/verify.py"
