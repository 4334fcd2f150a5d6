"""A small experiment with its report, made once."""

from pathlib import Path

import pytest
from html_page import Page
from small_experiment import small_experiment

from jointwear.publishing.report.assembly import assemble


@pytest.fixture(scope="session")
def experiment():
    return small_experiment()


@pytest.fixture(scope="session")
def data(experiment):
    return assemble(experiment.results, experiment.config)


@pytest.fixture(scope="session")
def markup(experiment):
    return Path(experiment.path("report/index.html")).read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def page(markup):
    return Page(markup)
