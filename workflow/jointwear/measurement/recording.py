"""Measured motion and torque of one data set, and which of its trajectories are held out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from jointwear.files.errors import InputError

#: Blocks of time that a single recording is split into.
BLOCKS = 5


@dataclass(frozen=True)
class Recording:
    """Samples of a robot with n joints, ordered in time within each trajectory.

    Attributes
    ----------
    time : (m,) [s]. trajectory : (m,) integer labels, each label one run of samples.
    position : (m, n) [rad]. torque : (m, n) on the joint side [N m].
    velocity, acceleration : (m, n) or None, then derived from the position.
    temperature : (m,) or (m, n) [degC], or None.
    encoder_step : resolution of the positions [rad], or None where it is estimated from them.
    torque_kind : what was logged as torque: that of the "motor" (from its current), the "command" of the controller,
        or that of a "link_sensor" behind the gear. encoder_side : whether positions are of the "motor" or the "link".
    units : role -> unit that the config or the file states, for messages; the arrays are in the project's.
    factors : those of the config that the arrays are multiplied by, :class:`~jointwear.measurement.stated.Stated`.
    missing : role -> numbers that were read as missing, as -999. unread : roles without a number, cells
        and torn rows that were left out, in words.
    train, test : labels to learn from and to hold out; None takes the last fifth of the trajectories as test.
    """

    time: np.ndarray
    trajectory: np.ndarray
    position: np.ndarray
    torque: np.ndarray
    velocity: np.ndarray | None = None
    acceleration: np.ndarray | None = None
    temperature: np.ndarray | None = None
    train: tuple[int, ...] | None = None
    test: tuple[int, ...] | None = None
    name: str = "recording"
    encoder_step: float | None = None
    torque_kind: str = "motor"
    encoder_side: str = "motor"
    units: Mapping[str, str] = field(default_factory=dict)
    factors: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    missing: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    unread: str = ""

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.position.shape[1]

    @property
    def labels(self) -> list[int]:
        """The trajectory labels in order of appearance."""
        _, first = np.unique(self.trajectory, return_index=True)
        return [int(self.trajectory[i]) for i in np.sort(first)]

    def part(self, chosen: np.ndarray) -> Recording:
        """Return the samples `chosen`, an index or mask over time."""

        def pick(values):
            return None if values is None else values[chosen]

        return replace(
            self,
            time=self.time[chosen],
            trajectory=self.trajectory[chosen],
            position=self.position[chosen],
            torque=self.torque[chosen],
            velocity=pick(self.velocity),
            acceleration=pick(self.acceleration),
            temperature=pick(self.temperature),
        )


def split(recording: Recording) -> Recording:
    """Return the recording with `train` and `test` filled in.

    A single trajectory is cut into contiguous blocks of time, never into random samples; without labels the last
    fifth of the trajectories (at least one) is held out.

    Raises
    ------
    InputError : if a label does not exist, or is in both lists.
    """
    labels = recording.labels
    if len(labels) == 1:
        count = len(recording.time)
        trajectory = np.minimum(np.arange(count) * BLOCKS // max(count, 1), BLOCKS - 1)
        recording = replace(recording, trajectory=trajectory)
        labels = list(range(BLOCKS))
    train, test = recording.train, recording.test
    for role, given in (("train", train), ("test", test)):
        for label in given or ():
            if label not in labels:
                raise InputError(
                    f"data set '{recording.name}': '{role}' names trajectory {label}, which is not in the data "
                    f"(allowed: {', '.join(map(str, labels))}); the nearest valid value is "
                    f"{min(labels, key=lambda known: abs(known - label))}"
                )
    if train is None and test is None:
        cut = len(labels) - max(1, len(labels) // 5)
        train, test = tuple(labels[:cut]), tuple(labels[cut:])
    elif train is None:
        train = tuple(label for label in labels if label not in test)
    elif test is None:
        test = tuple(label for label in labels if label not in train)
    both = sorted(set(train) & set(test))
    if both:
        raise InputError(f"data set '{recording.name}': trajectory {both[0]} is in 'train' and in 'test'")
    if not train or not test:
        raise InputError(f"data set '{recording.name}': 'train' and 'test' must each name at least one trajectory")
    return replace(recording, train=tuple(train), test=tuple(test))


def elapsed_time(time: np.ndarray, trajectory: np.ndarray) -> np.ndarray:
    """Return a time [s] that never runs backwards, shape (m,).

    Where every trajectory starts its clock anew the trajectories are laid end to end.
    """
    result = np.array(time, dtype=float)
    edges = np.flatnonzero((np.diff(trajectory) != 0) | (np.diff(result) < 0)) + 1
    step = float(np.median(np.diff(result))) if len(result) > 1 else 0.0
    for edge in edges:
        if result[edge] <= result[edge - 1]:
            result[edge:] += result[edge - 1] + step - result[edge]
    return result
