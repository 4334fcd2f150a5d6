# jointwear. `make help` lists the targets.
# Needs Python 3.11 or newer; everything else is installed into .venv from requirements locked with hashes.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

PYTHON ?= $(shell command -v python3.11 || command -v python3)
CORES ?= 2
VENV := .venv
BIN := $(VENV)/bin
REPORT := results/report/index.html

# An environment is named after its lock files, so that a changed lock file rebuilds it.
lock_of = $(shell cat $(1) | sha256sum | cut -c1-16)
RUN := $(VENV)/.run-$(call lock_of,requirements/run.txt)
TEST := $(VENV)/.test-$(call lock_of,requirements/run.txt requirements/test.txt)
PUBLISH := $(VENV)/.publish-$(call lock_of,requirements/run.txt requirements/publish.txt)
PLANTS := $(VENV)/.plants-$(call lock_of,requirements/run.txt requirements/test.txt requirements/plants.txt)
CLUSTER := $(VENV)/.cluster-$(call lock_of,requirements/run.txt requirements/cluster.txt)
CHECK_VENV := .venv-check
CHECK_LOCKS := $(addprefix requirements/,run.txt test.txt publish.txt cluster.txt check.txt)
CHECK := $(CHECK_VENV)/.check-$(call lock_of,$(CHECK_LOCKS))
BENCH_VENV := .venv-bench
BENCH := $(BENCH_VENV)/.bench-$(call lock_of,requirements/run.txt requirements/bench.txt)

PIP_INSTALL := -m pip install --disable-pip-version-check --quiet --quiet --require-hashes
SNAKEMAKE := PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/snakemake --cores $(CORES)

.PHONY: help
help:  ## Show this list
	@grep -E '^[a-z_-]+:.*  ## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z_-]+):.*  ## /\1\t/' | awk -F'\t' '{printf "  make %-14s %s\n", $$1, $$2}'

$(RUN):
	@"$(PYTHON)" -c 'import sys; sys.exit("jointwear needs Python 3.11 or newer, found " + sys.version.split()[0]) if sys.version_info < (3, 11) else None'
	@echo "building $(VENV) from requirements/run.txt"
	@rm -rf $(VENV)
	@"$(PYTHON)" -m venv $(VENV)
	@$(BIN)/python $(PIP_INSTALL) -r requirements/run.txt
	@touch $@

$(TEST): $(RUN)
	@echo "adding requirements/test.txt to $(VENV)"
	@rm -f $(VENV)/.test-*
	@$(BIN)/python $(PIP_INSTALL) -r requirements/test.txt
	@touch $@

$(PUBLISH): $(RUN)
	@echo "adding requirements/publish.txt to $(VENV)"
	@rm -f $(VENV)/.publish-*
	@$(BIN)/python $(PIP_INSTALL) -r requirements/publish.txt
	@touch $@

$(PLANTS): $(TEST)
	@echo "adding requirements/plants.txt to $(VENV)"
	@rm -f $(VENV)/.plants-*
	@$(BIN)/python $(PIP_INSTALL) -r requirements/plants.txt
	@touch $@

$(CLUSTER): $(RUN)
	@echo "adding requirements/cluster.txt to $(VENV)"
	@rm -f $(VENV)/.cluster-*
	@$(BIN)/python $(PIP_INSTALL) -r requirements/cluster.txt
	@touch $@

$(CHECK):
	@echo "building $(CHECK_VENV) from requirements: run, test, publish, cluster, check"
	@rm -rf $(CHECK_VENV)
	@"$(PYTHON)" -m venv $(CHECK_VENV)
	@$(CHECK_VENV)/bin/python $(PIP_INSTALL) $(addprefix -r ,$(CHECK_LOCKS))
	@touch $@

$(BENCH):
	@echo "building $(BENCH_VENV) from requirements/run.txt and requirements/bench.txt"
	@rm -rf $(BENCH_VENV)
	@"$(PYTHON)" -m venv $(BENCH_VENV)
	@$(BENCH_VENV)/bin/python $(PIP_INSTALL) -r requirements/run.txt -r requirements/bench.txt
	@touch $@

.PHONY: environment
environment: $(RUN)  ## Build .venv (what a run needs)

.PHONY: plants
plants: $(PLANTS)  ## Add MuJoCo and robot descriptions to .venv, for the tier "world" of the hidden-effect test

.PHONY: reproduce
reproduce: $(RUN)  ## Reproduce the paper: the whole workflow, then the path of the report
	@$(SNAKEMAKE)
	@echo "report: $(CURDIR)/$(REPORT)"

.PHONY: test
test: $(TEST)  ## Run the tests (under 10 minutes)
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n $(CORES) --dist loadfile --no-loadscope-reorder -m "not (long or browser or publish or slurm or docs or real or hostile or plants)"

.PHONY: test-long
test-long: $(TEST)  ## Run the tests that take seconds each: whole histories, whole searches, killed runs
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n $(CORES) --dist loadfile --no-loadscope-reorder -m long

.PHONY: test-real
test-real: $(PLANTS)  ## Test on logs of real robots (JOINTWEAR_DATA, or snakemake fetch_data)
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -m real tests/real

.PHONY: test-plants
test-plants: $(PLANTS)  ## Test the plants in MuJoCo of the hidden-effect test
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -m plants

.PHONY: test-browser
test-browser: $(CHECK)  ## Test the pages in headless Chromium (Debian: chromium chromium-driver)
	@PATH="$(CURDIR)/$(CHECK_VENV)/bin:$$PATH" $(CHECK_VENV)/bin/python -m pytest -m browser

.PHONY: test-publish
test-publish: $(CHECK)  ## Test crate, CF conventions, site, citation and the Kubernetes profile (Debian: rsync)
	@PATH="$(CURDIR)/$(CHECK_VENV)/bin:$$PATH" $(CHECK_VENV)/bin/python -m pytest -m publish

.PHONY: test-hostile
test-hostile: $(TEST)  ## Feed some 4,000 broken inputs to every reader (at most 15 minutes)
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n $(CORES) --dist loadfile -m hostile

.PHONY: test-slurm
test-slurm: $(TEST) $(CLUSTER)  ## Run the tiny reproduction on a real Slurm (Debian: slurm-wlm munge)
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -m slurm

.PHONY: test-docs
test-docs: $(TEST) $(PUBLISH) $(CLUSTER)  ## Run every command of the documentation
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -m docs

.PHONY: lint
lint: $(TEST)  ## Check style: ruff, snakefmt, snakemake --lint
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/snakefmt --check Snakefile workflow/rules
	@$(SNAKEMAKE) --lint

.PHONY: format
format: $(TEST)  ## Format the code
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .
	@$(BIN)/snakefmt Snakefile workflow/rules

.PHONY: bench
bench: $(RUN) $(BENCH)  ## Measure speed and memory, half an hour; PARTS="dynamics workflow" measures these alone
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python workflow/benchmarks --peers $(BENCH_VENV)/bin/python $(PARTS)

.PHONY: crate
crate: $(PUBLISH)  ## Pack the run as a Workflow Run RO-Crate (AGENT="Jane Doe" ORCID=... name who ran it)
	@$(SNAKEMAKE) crate
	@echo "crate: crate/ro-crate-metadata.json"

.PHONY: sbom
sbom: $(PUBLISH)  ## Write the software bill of materials (CycloneDX) beside the crate, name packages without a licence
	@PYTHONPATH=workflow $(BIN)/python -m jointwear.publishing.sbom sbom.cdx.json requirements/run.txt requirements/publish.txt

.PHONY: site
site: $(RUN)  ## Write the static site: report, further pages that are built, data, archive
	@$(SNAKEMAKE) site
	@echo "site: site/index.html"

.PHONY: test-versions
test-versions: $(RUN)  ## Compare results across cores, runs, Python 3.11 to 3.14 and the lower bounds of pyproject.toml
	@PATH="$(CURDIR)/$(BIN):$$PATH" PYTHONPATH=workflow $(BIN)/python workflow/benchmarks/versions.py

.PHONY: reference
reference: $(RUN)  ## Write docs/reference from schemas and docstrings
	@PYTHONPATH=workflow $(BIN)/python -m jointwear.publishing.reference docs/reference

# The pictures of the README: their page, as it looks in a window of this size.
shoot = chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1280,1050 --screenshot=docs/images/$(1).png "file://$(CURDIR)/$(2)" 2>/dev/null

.PHONY: pictures
pictures: reproduce  ## Take the pictures of the README anew (Debian: chromium)
	@$(SNAKEMAKE) discover --configfile config/examples/discover_puma560.yaml
	@$(SNAKEMAKE) monitor --configfile config/examples/monitor_puma560.yaml
	@$(call shoot,report,$(REPORT))
	@$(call shoot,discover,results/discover/puma560_hidden/discover.html)
	@$(call shoot,monitor,results/monitor/puma560_example/monitor.html)

.PHONY: lock
lock:  ## Renew requirements/*.txt from requirements/*.in
	@"$(PYTHON)" -m venv .venv-lock
	@.venv-lock/bin/pip install --quiet pip-tools
	@for name in run test plants bench publish cluster check peers; do .venv-lock/bin/pip-compile --quiet --upgrade --generate-hashes --no-emit-index-url \
	  --no-emit-find-links --no-emit-trusted-host --allow-unsafe --strip-extras \
	  --output-file requirements/$$name.txt requirements/$$name.in; done

.PHONY: clean
clean:  ## Remove results and caches, keep the environment
	@rm -rf results crate site sbom.cdx.json .snakemake .pytest_cache .hypothesis .ruff_cache
