"""Axes whose windows scatter: told once for a robot, no alarm."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from jointwear.monitor.findings.seen_growth import LOOSE, LOOSEST, loose_findings
from jointwear.monitor.presentation.to_answer import ASKING
from jointwear.monitor.watching.backlash import backlash_findings

HOURS = SimpleNamespace(end=3600.0 * np.arange(1, 9))
BASELINE = np.arange(8) < 4


def scattering(*sizes):
    """A watch of axes whose windows scatter by that much, None where no normal is known."""
    extra = [None if s is None else SimpleNamespace(dispersion=SimpleNamespace(extra=s**2)) for s in sizes]
    return SimpleNamespace(axes=extra)


def test_axes_whose_windows_scatter_are_told_in_one_sentence():
    (told,) = loose_findings(HOURS, BASELINE, scattering(0.005, 0.11, None, 0.06))
    assert (told["axes"], told["time"], told["kind"]) == ([2, 4], 4 * 3600.0, LOOSE)
    assert told["words"].startswith("The windows of axes 2 and 4 scatter by up to 11 %, so that growth alarms late")
    (told,) = loose_findings(HOURS, BASELINE, scattering(0.005, 0.11))
    assert told["words"].startswith("The windows of axis 2 scatter by 11 %,")
    assert LOOSE not in ASKING


def test_steady_axes_are_not_told():
    assert not loose_findings(HOURS, BASELINE, scattering(0.0, LOOSEST, None))


def test_what_hides_backlash_is_one_line():
    rests, light = "it rests in the baseline", "its load keeps one direction, so that the gear stays on one flank"
    (told,) = backlash_findings([light, rests, light, ""], 5.0)
    assert (told["time"], told["axes"]) == (5.0, [1, 2, 3])
    assert told["words"] == (
        "Backlash cannot be judged of axes 1 and 3: their loads keep one direction, so that the gear stays on one "
        "flank; of axis 2: it rests in the baseline."
    )
    assert not backlash_findings(["", ""], 0.0)
