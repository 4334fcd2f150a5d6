"""What can be wrong with a stretch of a log, and in which words a page says so."""

from __future__ import annotations

from enum import IntFlag


class Flag(IntFlag):
    """What was found in a window; several may hold at once."""

    GAP = 1
    DUPLICATE_STAMPS = 2
    CLOCK_RESET = 4
    NOT_FINITE = 8
    AT_REST = 16
    OUTSIDE_LIMITS = 32
    TORQUE_FROZEN = 64
    REFUSED = 128
    UNEXPLAINED = 256
    CONTRADICTED = 512
    SATURATED = 1024
    LATER = 2048
    SCATTERED = 4096
    SILENT = 8192
    COARSE_TORQUE = 16384
    COARSE_POSITION = 32768


#: Flags that are no reason why a window is not judged.
HARMLESS = (
    Flag.GAP | Flag.UNEXPLAINED | Flag.SATURATED | Flag.LATER | Flag.SCATTERED | Flag.SILENT | Flag.COARSE_TORQUE
    | Flag.COARSE_POSITION
)  # fmt: skip
#: Flags that keep a window (of that axis) from being judged, whatever its statistics are.
DISQUALIFYING = Flag.OUTSIDE_LIMITS | Flag.TORQUE_FROZEN | Flag.REFUSED | Flag.CONTRADICTED

FLAG_WORDS = {
    Flag.GAP: "a gap in the log",
    Flag.DUPLICATE_STAMPS: "repeated or stray time stamps, left out",
    Flag.CLOCK_RESET: "the clock was set back",
    Flag.NOT_FINITE: "values that are missing or absurd, left out",
    Flag.AT_REST: "at rest, or too slow to show friction",
    Flag.OUTSIDE_LIMITS: "positions far outside the limits of the joint",
    Flag.TORQUE_FROZEN: "the torque does not change while the axis moves",
    Flag.REFUSED: "the log contradicts the model (units, order or sign of the axes)",
    Flag.UNEXPLAINED: "the model explains much less of the torque than in the first log",
    Flag.CONTRADICTED: "the torque fits neither the model nor the first log: another unit or sign, or a fault",
    Flag.SATURATED: "the torque stays at a limit of its drive or sensor, left out there",
    Flag.LATER: "the torque turns later or earlier than in the first log, and is read at its time",
    Flag.SCATTERED: "time stamps that scatter from sample to sample, so that speeds are wrong",
    Flag.SILENT: "the torque keeps one value for a while in motion, left out there",
    Flag.COARSE_TORQUE: "the torque is written in coarser steps than in the first log",
    Flag.COARSE_POSITION: "the position is written in coarser steps than in the first log",
}
