"""A reading is one module: what it lacks is named, whoever wrote it."""

import inspect
from types import FunctionType, ModuleType

import pytest

from jointwear.files.errors import InputError
from jointwear.reproduction import readings
from jointwear.reproduction.readings import lag_peak


def altered(**changed):
    """The module lag_peak with other values; None takes one away."""
    module = ModuleType(lag_peak.__name__, lag_peak.__doc__)
    vars(module).update({**vars(lag_peak), **changed})
    for name in (name for name, value in changed.items() if value is None):
        delattr(module, name)
    return module


def minimum(correlation):
    return -correlation


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"STAGE": None}, "has no text STAGE; every reading says PAPER, STAGE and DEFAULT"),
        ({"STAGE": "locaton"}, "STAGE is 'locaton'; allowed: simulation, .*; did you mean 'location'"),
        ({"DEFAULT": "maximun"}, "DEFAULT is 'maximun'; allowed: maximum, absolute_maximum; did you mean 'maximum'"),
        ({"minimum": minimum}, "function 'minimum' has no docstring, which is its meaning in the reference"),
    ],
)
def test_a_reading_that_lacks_something_is_named(changed, words):
    for value in changed.values():
        if isinstance(value, FunctionType):
            value.__module__ = lag_peak.__name__
    with pytest.raises(InputError, match=rf"lag_peak\.py: {words}"):
        readings._checked(altered(**changed))


def test_every_stage_asks_something():
    assert {a.stage for a in readings.ambiguities().values()} == set(readings.STAGES)
    assert inspect.getdoc(lag_peak.maximum) == "At the maximum of R."
