"""A name that stands only beside a body that is carried is looked for beside that body again."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.search import repeatability
from jointwear.discovery.settings import Settings


@dataclass
class Part:
    """As much of a problem as leaving a group out needs."""

    settings: Settings
    loaded: bool = False
    train: np.ndarray = field(default_factory=lambda: np.ones(4, bool))
    measured: SimpleNamespace = field(
        default_factory=lambda: SimpleNamespace(trajectory=np.array([0, 0, 1, 1]), usable=np.full((4, 1), 10**6))
    )
    judged: tuple[int, ...] = (0,)


@dataclass
class Name:
    candidate: SimpleNamespace
    evidence: float
    repeated: float | None = None


def name(key):
    return Name(SimpleNamespace(key=key), 50.0)


@pytest.mark.parametrize("given", [True, False])
def test_each_run_finds_the_body_and_what_stands_beside_it(monkeypatch, given):
    monkeypatch.setattr(repeatability, "whitened", lambda problem: problem)
    monkeypatch.setattr(repeatability, "beside_slow_noise", lambda problem, ask: ask(problem))
    monkeypatch.setattr(repeatability, "search", lambda p: SimpleNamespace(problem=p, named=[name("payload")]))

    def beside(found):
        # A body that has been added to the load already must not be added again.
        assert found.problem.loaded is not given
        return SimpleNamespace(named=[*found.named, name("friction")])

    monkeypatch.setattr(repeatability, "search_beside", beside)
    settings = Settings(groups=(("a", (0,)), ("b", (1,))))
    outcome = SimpleNamespace(
        problem=Part(settings, loaded=True), named=[name("payload"), name("friction")], refusals=[]
    )
    kept = repeatability.repeat(outcome, Part(settings) if given else None)
    assert [(n.candidate.key, n.repeated) for n in kept.named] == [("payload", 1.0), ("friction", 1.0)]
    assert not kept.refusals
