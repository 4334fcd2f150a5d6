"""Lists and counts in words."""

import pytest

from jointwear.files.wording import count, digits_apart, listed, name_axes, numbered


def test_lists_have_commas_and_one_and():
    assert [listed("abc"[:k]) for k in (1, 2, 3)] == ["a", "a and b", "a, b and c"]
    assert numbered("joint", [3]) == "joint 3"
    assert numbered("joint", (j for j in (1, 2, 5))) == "joints 1, 2 and 5"
    assert (name_axes([]), name_axes([2]), name_axes([1, 2])) == ("", "axis 2", "axes 1 and 2")
    assert (count(1, "log"), count(2, "log"), count(2, "axis", "axes")) == ("1 log", "2 logs", "2 axes")


@pytest.mark.parametrize(
    ("value", "other", "digits"), [(0.989963, 0.99, 5), (1.0, 2.0, 3), (0.99, 0.99, 3), (1.0, 1.0 + 1e-13, 3)]
)
def test_two_numbers_that_differ_read_apart(value, other, digits):
    assert digits_apart(value, other) == digits
