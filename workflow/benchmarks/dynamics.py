"""Inverse dynamics with friction: ours against roboticstoolbox-python, on the same states, in one process.

Run with the Python of .venv-bench; prints JSON.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable

import numpy as np
import roboticstoolbox

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

STATES, CALLS, REPEATS = 200_000, 5_000, 7


def best(function: Callable[[], object]) -> float:
    """Shortest of several times [s]."""
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def main(robot: str) -> None:
    """Measure and print."""
    dynamics, peer = Dynamics(load_robot(robot)), roboticstoolbox.models.DH.Puma560()
    random = np.random.default_rng(1)
    lower, upper = dynamics.robot.lower, dynamics.robot.upper
    q = random.uniform(lower, upper, (STATES, 6))
    qd, qdd = random.uniform(-2, 2, (STATES, 6)), random.uniform(-5, 5, (STATES, 6))
    difference = float(np.abs(dynamics.inverse_dynamics(q, qd, qdd) - peer.rne(q, qd, qdd)).max())

    def single() -> None:
        for i in range(CALLS):
            peer.rne(q[i], qd[i], qdd[i])

    seconds = {
        "one_thread": best(lambda: dynamics.inverse_dynamics(q, qd, qdd, threads=1)) / STATES,
        "two_threads": best(lambda: dynamics.inverse_dynamics(q, qd, qdd, threads=2)) / STATES,
        "peer_batched": best(lambda: peer.rne(q, qd, qdd)) / STATES,
        "peer_per_call": best(single) / CALLS,
    }
    print(
        json.dumps(
            {
                "microseconds_per_state": {k: round(v * 1e6, 4) for k, v in seconds.items()},
                "two_threads_against_batched": round(seconds["peer_batched"] / seconds["two_threads"], 2),
                "two_threads_against_per_call": round(seconds["peer_per_call"] / seconds["two_threads"], 1),
                "one_thread_against_batched": round(seconds["peer_batched"] / seconds["one_thread"], 2),
                "largest_difference_nm": difference,
            }
        )
    )


if __name__ == "__main__":
    main(sys.argv[1])
