"""What all tests share: the project's files, and data of the original toolbox."""

import csv
import os
from pathlib import Path

from jointwear.running.processes import one_thread_each

one_thread_each()  # as Snakemake starts a job; before numpy is loaded

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from jointwear.reproduction import readings
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

#: Folders of tests that run the workflow itself: a file of these takes minutes, and must not be the last to begin.
FIRST = ("results", "workflow")
ROOT = Path(__file__).resolve().parent.parent
ORACLE = Path(__file__).resolve().parent / "data" / "oracle"

# A test by properties says what holds, not how fast: of itself hypothesis fails an example that takes more than 200 ms,
# which beside other work any may.
settings.register_profile("jointwear", settings(), deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("jointwear")

# Services that tests start are on this machine, whatever proxy leads to others.
for _name in ("NO_PROXY", "no_proxy"):
    os.environ[_name] = ",".join(filter(None, (os.environ.get(_name), "127.0.0.1", "localhost")))


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: item.path.parent.name not in FIRST)


class Oracle:
    """Columns of one oracle file; see tests/data/oracle/README.md."""

    def __init__(self, name: str) -> None:
        with open(ORACLE / f"{name}.csv", encoding="utf-8") as file:
            self._rows = list(csv.DictReader(file))

    def column(self, name: str) -> np.ndarray:
        return np.array([float(row[name]) for row in self._rows])

    def by_joint(self, name: str) -> np.ndarray:
        """One row a state, one column a joint."""
        return self.column(name).reshape(-1, 6)


@pytest.fixture(scope="session")
def oracle():
    return Oracle


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def puma():
    return Dynamics(load_robot(ROOT / "config/robots/puma560.yaml"))


@pytest.fixture(scope="session")
def default_reading():
    return {name: a.default for name, a in readings.ambiguities().items()}
