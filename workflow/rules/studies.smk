# Long studies: a page of their own beside the report, and copies in data/studies from which the report quotes them.
wildcard_constraints:
    study="|".join(STUDY_PICTURES),


rule store_studies:
    input:
        expand("results/{study}/stored.txt", study=STUDY_PICTURES),


rule build_study_page:
    input:
        chapter="results/{study}/chapter.json",
        figures=lambda wildcards: study_pictures(wildcards.study),
        templates=[*TEMPLATES, *templates("study.html.j2")],
        modules=modules_of("build_study_page"),
    output:
        "results/{study}/index.html",
    log:
        "results/logs/build_study_page/{study}.log",
    params:
        study=lambda wildcards: wildcards.study,
    script:
        "../scripts/build_study_page.py"


# Declares no output in data/studies: the report must never wait for a study because its copy is old.
rule store_study:
    input:
        "results/{study}/chapter.json",
        lambda wildcards: study_pictures(wildcards.study),
    output:
        "results/{study}/stored.txt",
    log:
        "results/logs/store_study/{study}.log",
    shell:
        "mkdir -p data/studies/{wildcards.study} && cp {input} data/studies/{wildcards.study}/"
        " && sha256sum {input} > {output} 2> {log}"


# The verdicts of the report itself, which the first page of the project tells.
rule store_reproduction:
    input:
        scores="results/report/summary.json",
        modules=modules_of("store_reproduction"),
    output:
        "results/reproduction/stored.json",
    log:
        "results/logs/store_reproduction.log",
    script:
        "../scripts/store_reproduction.py"


# As store_study: declares no output in data/studies.
rule keep_reproduction:
    input:
        "results/reproduction/stored.json",
    output:
        "results/reproduction/kept.txt",
    log:
        "results/logs/keep_reproduction.log",
    shell:
        "cp {input} data/studies/reproduction.json && sha256sum {input} > {output} 2> {log}"
