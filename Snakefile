# jointwear: wear in the joints of industrial robots, simulated, detected, located and explained.
# A table of contents; every stage is one file of workflow/rules.
from snakemake.utils import min_version

min_version("9.0")


configfile: "config/config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/trajectory.smk"
include: "workflow/rules/simulation.smk"
include: "workflow/rules/features.smk"
include: "workflow/rules/detection.smk"
include: "workflow/rules/location.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/report.smk"


rule all:
    default_target: True
    input:
        "results/report/index.html",
