"""What a configuration says of a log already: advice to give it again would lead in a circle."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from jointwear.files.wording import listed, numbered, significant

#: What a factor may differ from one by, relative, and still be none: factors are advised in three digits.
NEARLY_ONE = 0.01


@dataclass(frozen=True)
class Stated:
    """`units`: role -> unit that the configuration or the log states. `factors`: one factor an axis, or one for all, of
    the keys that turn or scale what is logged, where the configuration has them."""

    units: Mapping[str, str] = field(default_factory=dict)
    factors: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    def instead(self, key: str, wanted: Mapping[int, float]) -> str:
        """Return in words what to do with a key that has a factor already, so that what is read is multiplied by
        `wanted`, 0-based axis -> factor; empty where it has none for these axes."""
        has = self.factors.get(key, ())
        now = {axis: has[axis if len(has) > 1 else 0] for axis in wanted if has}
        if all(value == 1.0 for value in now.values()):
            return ""
        then = [now[axis] * wanted[axis] for axis in now]
        said = f"'{key}' has {_figures(now.values())} for {numbered('joint', [axis + 1 for axis in now])}"
        others = [value for axis, value in enumerate(has) if axis not in now and len(has) > 1]
        if all(abs(value - 1.0) < NEARLY_ONE for value in [*then, *others]):
            return f"{said}: take '{key}' out"
        return f"{said}: make that {_figures(then)}"


def _figures(values: Iterable[float]) -> str:
    told = [significant(value) for value in values]
    return told[0] if len(set(told)) == 1 else listed(told)
