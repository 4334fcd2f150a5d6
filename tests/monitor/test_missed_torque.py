"""Growth in percent is unsure where the model misses much of the torque that friction is told from."""

import numpy as np
import pytest

from jointwear.monitor.findings.missed_torque import unsure_percent_findings
from jointwear.monitor.reading.windows import blank_statistics

BASELINE = np.arange(8) < 4


def windows(noise, quick):
    """Windows of two axes whose regression leaves `noise` [N m], and of whose variance a share is quick."""
    found = blank_statistics(3600.0 * np.arange(8), 3600.0, np.ones(2))
    found.count[:], found.freedom[:], found.far_count[:] = 100, 100, 50
    found.residual_square[:] = 100 * np.square(noise)
    found.pulse_far[:] = 50 * np.square(noise) * quick
    return found


@pytest.mark.parametrize(
    ("noise", "quick", "changed", "told"),
    [
        ((1.2, 0.2), 0.01, (True, True), [1]),
        ((1.2, 1.2), 0.01, (False, True), [2]),
        ((1.2, 1.2), 0.01, (False, False), None),
        ((0.4, 0.4), 0.01, (True, True), None),
        ((1.2, 1.2), 0.2, (True, True), None),
    ],
)
def test_an_axis_is_told_that_has_changed_and_whose_torque_is_missed(noise, quick, changed, told):
    found = unsure_percent_findings(windows(noise, quick), BASELINE, np.full((2, 2), 4.0), np.array(changed))
    assert [f["axes"] for f in found] == ([] if told is None else [told])
    if told:
        assert "missed torque of 30 % of the Coulomb friction" in found[0]["words"]
