"""Run one hostile input in a process of its own: what it does wrong is seen from outside, whatever that is."""

from __future__ import annotations

import math
import os
import pickle
import resource
import select
import signal
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from jointwear.files.errors import InputError

#: Longest processor time that one input may take [s], and how many times as long one that waits may take by the clock:
#: others may use the machine too.
LIMIT, WAITS = 10.0, 6.0


@dataclass(frozen=True)
class Outcome:
    """How a call ended: `accepted` with its value, `refused` with its message, or `broken` with what was seen."""

    kind: str
    value: Any


def outcome_of(call: Callable[[], Any], limit: float = LIMIT) -> Outcome:
    """Call a function in a forked process; a traceback, a crash and more than `limit` seconds are `broken`."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit), math.ceil(limit) + 1))
        _answer(call, write)
    os.close(write)
    end, parts = time.monotonic() + WAITS * limit, []
    with os.fdopen(read, "rb", buffering=0) as pipe:
        while True:
            if not select.select([pipe], [], [], max(0.0, end - time.monotonic()))[0]:
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
                return Outcome("broken", f"took more than {WAITS * limit:g} s")
            part = pipe.read(1 << 16)
            if not part:
                break
            parts.append(part)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU:
        return Outcome("broken", f"took more than {limit:g} s of processor time")
    if status or not parts:
        return Outcome("broken", f"the process ended with status {status}")
    return Outcome(*pickle.loads(b"".join(parts)))


def _answer(call: Callable[[], Any], pipe: int) -> None:
    """In the child: call, send the outcome, and leave without what the test session would do at its end."""
    code = 0
    try:
        # What libraries print about damaged files is not the matter here.
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        try:
            answer = ("accepted", call())
        except InputError as error:
            answer = ("refused", str(error))
        except BaseException:
            answer = ("broken", traceback.format_exc(limit=-12))
        data = pickle.dumps(answer)
        while data:
            data = data[os.write(pipe, data) :]
    except BaseException:
        code = 1
    finally:
        os._exit(code)


def held(outcome: Outcome) -> Outcome:
    """Return an outcome that is not broken; a refusal must be one line that can be shown."""
    assert outcome.kind != "broken", outcome.value
    if outcome.kind == "refused":
        assert outcome.value.isprintable(), outcome.value
        assert 0 < len(outcome.value) <= 2000
    return outcome
