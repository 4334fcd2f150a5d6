"""What is true of a case: how well each hidden thing can be seen in the log, and what it cannot be told from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.studies.challenge.separability import IDENTIFIABLE
from jointwear.studies.sieve import REST, Sieve
from jointwear.studies.world.chains import Chain, with_body
from jointwear.studies.world.hidden import Hidden
from jointwear.studies.world.maker import Maker
from jointwear.studies.world.plant import DriveParameters
from jointwear.studies.world.rivals import energies_left
from jointwear.studies.world.robot_files import write_robot
from jointwear.studies.world.run import Log
from jointwear.studies.world.setting import INERTIAL_PRIOR, TEST, Setting
from jointwear.studies.world.visibility import Samples, sieve_samples

#: Rate [Hz] that the judgement of visibility looks at, at most.
_LOOK = 125


class Judge:
    """Says how well hidden things can be seen."""

    def __init__(self, setting: Setting, robot: Robot, real: Robot, noise, heat, starts, rng) -> None:
        self.setting, self.robot, self.heat, self.starts, self.rng = setting, robot, heat, starts, rng
        self.noise = noise
        keep = max(1, round(setting.rate / _LOOK))
        self.stride, self.rate = setting.sub * keep, setting.rate / keep
        # Fewer samples carry the same information where the noise is white; coloured noise fades between them.
        self.noise = noise / np.sqrt(keep) if not setting.colour else noise
        self.colour = setting.colour**keep
        if setting.torque == "link_sensor":
            real = real.without_drives()
        self.real = real

    def samples(self, logs: Sequence[Log]) -> Samples:
        """Return the motion at the instants that are looked at."""
        q, v, a = (
            np.concatenate([getattr(log, x)[:: self.stride] for log in logs])
            for x in ("position", "velocity", "acceleration")
        )
        label = np.repeat(np.arange(len(logs)), len(q) // len(logs))
        return Samples(label, q, v, a, self.rate)

    def torque(self, clean: Sequence[np.ndarray]) -> np.ndarray:
        """Return the torque channel at these instants."""
        return np.concatenate([c[:: self.stride] for c in clean])

    def plain(self, samples: Samples) -> np.ndarray:
        """Return the torque of the same motion with nothing hidden (m, n) [N m]."""
        return Dynamics(self.real).inverse_dynamics(samples.position, samples.velocity, samples.acceleration)

    def sieve(self, samples: Samples, without: tuple[str, int] | None = None) -> Sieve:
        """Return the projection for the training recordings."""
        drives = self.setting.torque != "link_sensor"
        train = samples.recording != TEST
        return sieve_samples(samples, self.robot, train, self.noise, self.colour, INERTIAL_PRIOR, drives, without)

    def add_energy_of_parameter(
        self, wrong: dict[str, Any], logs: Sequence[Log], chain: Chain, drives: DriveParameters, folder: Path
    ) -> None:
        """Add to `wrong` the energy of a wrong parameter of the model itself."""
        samples, axis = self.samples(logs), wrong["axis"] - 1
        names = {"coulomb_friction": "coulomb", "viscous_friction": "viscous", "motor_inertia": "armature"}
        other_chain, other = chain, drives
        if wrong["parameter"] == "link_inertia":
            f = 1 + wrong["share"]
            other_chain = with_body(chain, axis, chain.mass[axis] * f, chain.com[axis], chain.inertia[axis] * f)
        else:
            field = names[wrong["parameter"]]
            values = getattr(drives, field).copy()
            values[axis] *= 1 + wrong["share"]
            other = replace(drives, **{field: values})
        gear = np.ones(chain.joints)
        one = write_robot(folder / "truth", "one", other_chain, other, gear)
        none = write_robot(folder / "truth", "none", chain, drives, gear)
        q, v, a = samples.position, samples.velocity, samples.acceleration
        change = Dynamics(one).inverse_dynamics(q, v, a) - Dynamics(none).inverse_dynamics(q, v, a)
        wrong["energy"] = self.sieve(samples, (wrong["parameter"], axis)).energy(change)


def describe(facts, hidden: Sequence[Hidden], make: Maker, judge: Judge, logs: Sequence[Log], clean) -> None:
    """Add to `facts` what is hidden, how well it can be seen, and what it cannot be told from."""
    samples, torque = judge.samples(logs), judge.torque(clean)
    whole = torque - judge.plain(samples)
    if len(hidden) == 1:
        terms = [whole]
    else:
        # The torque of one of two: what is there, less what is there without it; on nearly the same motion.
        terms = []
        for item in hidden:
            alone = make.logs([item])
            there = judge.samples(alone)
            terms.append(judge.torque(make.channel(alone, [item])) - judge.plain(there))
    sieve = judge.sieve(samples)
    held = (samples.recording == TEST)[:, None] & (np.abs(samples.velocity) >= REST)
    for k, (item, term) in enumerate(zip(hidden, terms, strict=True)):
        others = [t for j, t in enumerate(terms) if j != k]
        energy = sieve.energy(term, others)
        entry = {
            "effect": item.name,
            "axis": None if item.axis is None else item.axis + 1,
            "source_axis": None if item.source is None else item.source + 1,
            "also": [j + 1 for j in item.also],
            "form": item.form,
            "size": item.size,
            "unit": item.unit,
            "parameters": item.parameters,
            "energy": energy,
            "peak": np.abs(np.where(held, term, 0.0)).max(axis=0).tolist(),
        }
        if facts["kind"] != "outside":
            entry["rivals"] = (
                energies_left(
                    item.name, item.axis, term, judge.real, samples, torque, judge.starts, judge.heat, sieve, judge.rng
                )
                if energy > IDENTIFIABLE
                else {}
            )
        facts["effects"].append(entry)
