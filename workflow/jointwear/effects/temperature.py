"""What the three temperature effects share: a reference, and whether the temperature varies at all."""

from collections.abc import Callable, Mapping

import numpy as np

from jointwear.effects.state import State

#: Smallest spread of temperature [K] over the data that counts as a variation.
SMALLEST_SPREAD = 0.5


def reference_temperature(state: State, axis: int) -> float | None:
    """Return the middle of the temperatures of `axis` [degC], or None where they are unknown or hardly vary."""
    values = state.temperature[..., axis]
    values = values[np.isfinite(values)]
    if not values.size or np.ptp(values) < SMALLEST_SPREAD:
        return None
    return float(round(0.5 * (values.min() + values.max()), 2))


def temperature_shape(
    carrier: Callable[[State, int, Mapping[str, float]], np.ndarray],
) -> Callable[[State, int, Mapping[str, float]], tuple[np.ndarray, np.ndarray]]:
    """Return the `shape` of an effect with this carrier; an unknown temperature counts as the reference."""

    def shape(state: State, axis: int, parameters: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
        return carrier(state, axis, parameters), np.nan_to_num(
            state.temperature[..., axis], nan=parameters["reference"]
        )

    return shape


def warming(state: State, axis: int, reference: float) -> np.ndarray:
    """Return temperature above the reference [K], shape (...,); 0 where the temperature is unknown."""
    return np.nan_to_num(state.temperature[..., axis] - reference, nan=0.0)
