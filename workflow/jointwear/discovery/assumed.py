"""What discovery assumes of noise, band, log and drive: the one record of these limits, each with source or meaning.

:mod:`jointwear.discovery.settings` is the record of what decides names. Those here stand before it: they say what is
noise, up to where it can be told from motion, and how wide priors are. None depends on the robot. Without a source they
were chosen on choosing cases; none is a limit of a score. Read them as `assumed.NAME`: `python -m
jointwear.studies.world.sensitivity --assumed` moves each of them by 30 % both ways.

Numbers elsewhere in these modules are none of this kind: grids that are searched, rounds and other bounds on time,
fewest samples of a statistic, ridges, and what follows from a definition (half is most of something; the two numbers
of :mod:`jointwear.discovery.search.calibration` belong to its fit and change with it alone).
"""

from __future__ import annotations

import math

#: Length [s] of a block of time: within most of it noise forgets most of what it was (:func:`longest_memory`), so that
#: blocks are like recordings of their own; what lasts longer is structure. A step within a record, which must not do
#: better than an effect that follows time, is tried as often.
BLOCK = 0.5
#: Times a frequency from which another is apart from it. Columns of a link that swings end so far above the cut-off of
#: columns of timing, and what a gear does is a term beside it: what they share with the residual speaks against them
#: below the swing, and at the swing their size is known; further up there is noise that a term would follow. Quick
#: noise begins so far above slow noise, and what shakes the arm is asked up to so far below half of the rate, towards
#: which derived accelerations have noise of other kinds.
OCTAVE = 2.0


def slow() -> float:
    """Return the frequency [Hz] of one wave in a block: slower are motion, wind and drift."""
    return 1.0 / BLOCK


def longest_memory() -> float:
    """Return the time [s] within which noise forgets to 37 % at the slowest: to half within half of a block."""
    return 0.5 * BLOCK / math.log(2.0)


# The noise of a torque.

#: Power at the low end of the band over that at the high end beyond which a residual is no sensor's noise: white noise
#: has 1, of an autoregression of 0.9 it is 400, of a robot whose model is far off 40,000 and more.
REDDEST = 1e3
#: Share of the noise in a band that a fit has to leave for the band to say something.
NOISE_LEFT = 0.2
#: Times the median over records up to which the power of one record counts: noise is there all the time.
FULLEST_RECORD = 2.0
#: Share of the knots of structure that the fit behind the noise has, for noise to keep most of its freedom.
COARSE = 0.6

# The band in which motion is told from noise, and the clock.

#: Share of a sampling period to which the time of a sample is known: that of position and torque, and the evenness of
#: the steps.
CLOCK = 0.05
#: Times the power of the residual that the nominal torque has at most above the frequencies of the motion.
UNDER_MOTION = 2.0
#: Time [s] left out on either side of a reversal that is not resolved.
BESIDE = 0.1

# Drives that two joints share.

#: Speed [rad/s] of a shared drive below which it may stick between two samples.
STICKS = 0.05

# Priors, as standard deviations.

#: Friction of an axis that stands for it when priors are set, at least, over the RMS of its torque.
LEAST_FRICTION = 0.03
