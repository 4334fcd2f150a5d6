"""The same work on many things in several processes."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

Thing = TypeVar("Thing")
Result = TypeVar("Result")

#: Parts that each process gets its share in: things differ in size.
PARTS = 4
#: Environment variables that say how many threads linear algebra starts.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def one_thread_each() -> None:
    """Let linear algebra compute with one thread, here and in every process that this one starts.

    It starts a thread for every core in every process, which then wait for each other; discovery takes several times as
    much processor time with two. The variables are read when a library is loaded: to be called before numpy is
    imported. A variable that is set already keeps its value.
    """
    for name in THREADS:
        os.environ.setdefault(name, "1")


def single_threaded(processes: int) -> ProcessPoolExecutor:
    """Return a pool whose processes compute with one thread each; they are not forked, and load numpy anew."""
    one_thread_each()
    return ProcessPoolExecutor(processes, mp_context=get_context("spawn"))


def in_processes(work: Callable[[Thing], Result], things: Sequence[Thing], processes: int) -> list[Result]:
    """Return what `work` makes of each thing, in order, one by one where there is one process or one thing.

    Processes are forked, so that they need not import the library again, which takes longer than reading many logs;
    where a system forks badly (anything but Linux) there is one.

    Raises
    ------
    Exception : the first that `work` raises.
    """
    processes = min(processes, len(things)) if sys.platform == "linux" else 1
    if processes <= 1:
        return [work(thing) for thing in things]
    size = -(-len(things) // (PARTS * processes))
    with ProcessPoolExecutor(processes, mp_context=get_context("fork")) as pool:
        return list(pool.map(work, things, chunksize=size))
