"""The same work in one process and in several."""

import os

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from jointwear.running.processes import in_processes


def tripled(number):
    return 3 * number, os.getpid()


def refused(number):
    if number == 5:
        raise ValueError("five")
    return number


@pytest.mark.parametrize("processes", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 17])
def test_results_come_in_order_whatever_the_processes(count, processes):
    found = in_processes(tripled, range(count), processes)
    assert [value for value, _ in found] == [3 * k for k in range(count)]
    at_home = {process for _, process in found} <= {os.getpid()}
    assert at_home == (processes == 1 or count <= 1)


@pytest.mark.parametrize("processes", [1, 2])
def test_what_the_work_raises_is_raised(processes):
    with pytest.raises(ValueError, match="five"):
        in_processes(refused, range(9), processes)


def test_tests_compute_with_one_thread():
    """As Snakemake starts a job; with a thread for every core discovery takes several times as much processor time."""
    np.linalg.inv(np.eye(2))
    assert {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"} == {1}
