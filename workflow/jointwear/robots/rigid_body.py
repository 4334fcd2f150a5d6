"""Which inertia a rigid body can have; without numpy, because the Snakefile checks robots at every call."""

from __future__ import annotations

#: Negative principal moments up to this share of the largest entry are round-off.
ROUND_OFF = 1e-9
#: Share of its size by which a moment may exceed the sum of the other two: tables give three digits.
ROUNDING = 5e-3


def has_no_negative_moment(six: list[float]) -> bool:
    """Whether (xx, yy, zz, xy, yz, xz) has no negative principal moment: all principal minors are >= 0."""
    xx, yy, zz, xy, yz, xz = six
    size = max(map(abs, six)) or 1.0
    xx, yy, zz, xy, yz, xz = (value / size for value in six)
    pairs = (xx * yy - xy * xy, yy * zz - yz * yz, xx * zz - xz * xz)
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return min(xx, yy, zz, *pairs, determinant) >= -ROUND_OFF


def obeys_triangle_inequality(six: list[float]) -> bool:
    """Whether no principal moment exceeds the sum of the other two, up to :data:`ROUNDING`.

    The principal values of tr(I)/2 - I are half of what the other two moments are more than the third, and with I
    they turn with the frame.
    """
    xx, yy, zz, xy, yz, xz = six
    half = (xx + yy + zz) / 2 * (1 + ROUNDING)
    return has_no_negative_moment([half - xx, half - yy, half - zz, -xy, -yz, -xz])


def fault_of_inertia(six: list[float]) -> str:
    """Return in words why no rigid body has the inertia (xx, yy, zz, xy, yz, xz), empty if one may have."""
    if not has_no_negative_moment(six):
        return "a principal moment is negative"
    if not obeys_triangle_inequality(six):
        return "a principal moment is larger than the sum of the other two"
    return ""
