"""Time derivatives and delays along ordered samples; zero for unordered ones."""

import numpy as np

from jointwear.effects.state import State, record_slices


def second_derivative(state: State, values: np.ndarray) -> np.ndarray:
    """Return the second time derivative of `values` (m,) within each record, 0 without an order."""
    result = np.zeros(np.shape(values))
    if state.record is None:
        return result
    for part in record_slices(state):
        t, x = state.time[part], values[part]
        if len(t) >= 3:
            before, after = np.diff(t)[:-1], np.diff(t)[1:]
            slope = np.diff(x) / np.diff(t)
            result[part.start + 1 : part.stop - 1] = 2 * (slope[1:] - slope[:-1]) / (before + after)
    return result


def delayed(state: State, values: np.ndarray, delay: float) -> np.ndarray:
    """Return `values` (m,) as they were `delay` [s] earlier in the same record; unchanged without an order."""
    if state.record is None:
        return values
    result = np.empty(np.shape(values))
    for part in record_slices(state):
        t = state.time[part]
        result[part] = np.interp(t - delay, t, values[part])
    return result
