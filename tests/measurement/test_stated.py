"""What a configuration says already, and advice beside it."""

from jointwear.measurement.checks.axis_readings import Reading
from jointwear.measurement.stated import Stated


def test_a_factor_that_is_there_is_multiplied_in_words():
    stated = Stated(factors={"scale": (2.0, 1.0, -1.0), "sign": (-1.0,)})
    assert stated.instead("scale", {0: 0.5}) == "'scale' has 2 for joint 1: make that 1"
    assert stated.instead("scale", {0: 3.0, 2: 3.0}) == "'scale' has 2 and -1 for joints 1 and 3: make that 6 and -3"
    assert stated.instead("sign", {2: -1.0}) == "'sign' has -1 for joint 3: take 'sign' out"


def test_nothing_is_said_of_a_factor_that_is_not_there():
    stated = Stated(factors={"scale": (2.0, 1.0)})
    assert stated.instead("scale", {1: -1.0}) == ""
    assert stated.instead("sign", {1: -1.0}) == ""


def test_a_reading_that_asks_for_two_keys_tells_of_each_what_it_needs():
    reading = Reading("position", (2,))
    half = reading.remedy_beside(Stated(factors={"sign": (1.0, 1.0, -1.0)}))
    assert half == "'sign' has -1 for joint 3: take 'sign' out and give 'scale' with -1 for joint 3"
    assert reading.remedy_beside(Stated()) == reading.remedy


def test_the_scale_of_a_joint_is_that_of_now_times_what_is_advised():
    reading = Reading("scale", (1,), factors=(4.0,))
    assert reading.remedy_beside(Stated(factors={"scale": (1.0, 8.0)})) == "'scale' has 8 for joint 2: make that 2"


def test_the_unit_that_a_joint_looks_like_follows_the_stated_one():
    radians = Reading("unit", (1,), factors=(57.29577951308232,))
    assert radians.looks_like(Stated({"position": "deg"})) == "rad"
    assert radians.looks_like(Stated()) == ""
