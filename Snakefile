# jointwear: wear in the joints of industrial robots, simulated, detected, located and explained.
# A table of contents; every stage is one file of workflow/rules.
from snakemake.utils import min_version

min_version("9.0")


# Used only with --software-deployment-method apptainer: the Python that requirements/run.txt is locked for.
container: "docker://python:3.11"


include: "workflow/rules/common.smk"
include: "workflow/rules/registry.smk"
include: "workflow/rules/trajectory.smk"
include: "workflow/rules/simulation.smk"
include: "workflow/rules/features.smk"
include: "workflow/rules/detection.smk"
include: "workflow/rules/outputs_of_report.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/inputs_of_discover.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/crate.smk"
include: "workflow/rules/verify.smk"
include: "workflow/rules/site.smk"
include: "workflow/rules/recover.smk"
include: "workflow/rules/multiverse.smk"
include: "workflow/rules/recover_jointly.smk"
include: "workflow/rules/side_by_side.smk"
include: "workflow/rules/inputs_of_monitor_study.smk"
include: "workflow/rules/monitor_study.smk"
include: "workflow/rules/shop_floor.smk"
include: "workflow/rules/studies.smk"
include: "workflow/rules/discover.smk"
include: "workflow/rules/inputs_of_challenge.smk"
include: "workflow/rules/challenge.smk"
include: "workflow/rules/inputs_of_monitor.smk"
include: "workflow/rules/monitor.smk"
include: "workflow/rules/learn_normal.smk"
include: "workflow/rules/inputs_of_fleet.smk"
include: "workflow/rules/fleet.smk"


rule all:
    default_target: True
    input:
        "results/report/index.html",


include: "workflow/rules/everything.smk"
include: "workflow/rules/checks_of_the_call.smk"
