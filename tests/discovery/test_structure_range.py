"""The range that is told of structure without a name is that of the columns that hold it."""

import numpy as np

from jointwear.discovery.problem.candidates import Seen
from jointwear.discovery.search.leftovers import range_covered
from jointwear.discovery.structure import Basis


def test_columns_that_hold_nothing_do_not_move_the_range():
    values = np.linspace(0.0, 3.0, 300, endpoint=False)
    columns = (np.arange(3) == np.floor(values)[:, None]).astype(float)
    # Nothing is judged in the first third: the strongest of what is left is the last.
    good = np.array([False, True, True])
    held = columns[:, good]
    seen = Seen(held, good, np.array([1.0, 50.0]), np.eye(2), np.eye(2))
    low, high = range_covered(Basis("position", "rad", columns, values), seen, np.arange(100, 300))
    assert low == 2.0
    assert high == values[-1]
