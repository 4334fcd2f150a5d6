"""What discovery assumes of noise, band, log and drive: the one record of these limits, each with source or meaning.

:mod:`jointwear.discovery.settings` is the record of what decides names. Those here stand before it: they say what is
noise, up to where it can be told from motion, how wide priors are, and what a written model is asked. None depends on
the robot. Without a source they were chosen on choosing cases; none is a limit of a score. Read them as `assumed.NAME`:
`python -m jointwear.studies.world.sensitivity --assumed` moves each of them by 30 % both ways.

Numbers elsewhere in these modules are none of this kind: grids that are searched, rounds and other bounds on time,
fewest samples of a statistic, ridges, and what follows from a definition (half is most of something; the two numbers
of :mod:`jointwear.discovery.calibration` belong to its fit and change with it alone).
"""

from __future__ import annotations

# The noise of a torque.

#: Time [s] within which noise forgets to 37 %; what lasts longer is structure.
LONGEST_MEMORY = 0.35
#: Frequency [Hz] below which power is of what lasts for seconds: there motion, wind and drift are.
SLOW = 2.0
#: Times :data:`SLOW` up to which power is of noise that has nothing to do with what is slow; from half of it on, which
#: leaves a gap.
QUICK = 3.0
#: Times the density of the quick band that noise has at most in the slow one. First-order noise that forgets to 37 %
#: within a tenth of a second has 5, so has the reddest of 60 plants with nothing hidden; a torque that comes and goes
#: with the wind 50 to 1,300.
SLOW_NOISE = 10.0
#: Power at the low end of the band over that at the high end beyond which a residual is no sensor's noise: white noise
#: has 1, of an autoregression of 0.9 it is 400, of a robot whose model is far off 40,000 and more.
REDDEST = 1e3
#: Share of the noise in a band that a fit has to leave for the band to say something.
NOISE_LEFT = 0.2
#: Times the median over records up to which the power of one record counts: noise is there all the time.
FULLEST_RECORD = 2.0
#: Times the density of the noise model from which slow noise is denser than chance has it.
NOTABLE = 1.2
#: Standard deviation of what the logarithm of a density of noise changes by in an octave: noise of one pole, 1.4.
SLOPE = 1.0
#: Standard deviations that noise does not reach: of a share of an octave (each octave of each axis is asked), of the
#: residual where a shared drive sticks, and of a residual that counts as structure. One sample that jumps is no regime,
#: and a regime of many samples loses nothing.
SIGMAS = 4.0
#: Share of the knots of structure that the fit behind the noise has, for noise to keep most of its freedom.
COARSE = 0.6
#: Samples for each column of that fit from which it may hold still more columns.
ROOM = 15

# The band in which motion is told from noise, and the clock.

#: Times the cut-off of columns of timing up to which the columns of a link that swings end, and what a gear does is a
#: term beside it. What they share with the residual speaks against them below the swing, and at the swing their size is
#: known; further up there is noise that a term would follow.
OCTAVE = 2.0
#: Share of a sampling period to which the time of a sample is known: that of position and torque, and the evenness of
#: the steps.
CLOCK = 0.05
#: Times the power of the residual that the nominal torque has at most above the frequencies of the motion.
UNDER_MOTION = 2.0
#: Share of the residual that noise of derived accelerations is at most where it is asked what shakes the arm.
DERIVED = 0.25
#: Share of the rate up to which that is asked: towards half of it derived accelerations have noise of other kinds.
HIGHEST = 0.25
#: Share below which nothing is said to move the arm: noise of a sensor alone comes out at up to 0.08.
SHAKEN = 0.1
#: Time [s] left out on either side of a reversal that is not resolved.
BESIDE = 0.1
#: Waves of a motor turn that have to be resolved for the angle of the motor to be an argument of structure.
RESOLVED_ORDER = 6.0
#: Spans of the data, of a temperature or a position, beyond them up to which an effect may vanish.
BEYOND = 0.25
#: Share of the samples, the slowest of an axis, on which filters and lags take the least of a wave.
SLOWEST_SAMPLES = 1 / 3

# Drives that two joints share.

#: Speed [rad/s] of a shared drive below which it may stick between two samples.
STICKS = 0.05
#: Largest share of the squared residual elsewhere that the friction of the shared drive may leave.
EXPLAINED = 0.7

# Priors, as standard deviations.

#: Friction of an axis that stands for it when priors are set, at least, over the RMS of its torque.
LEAST_FRICTION = 0.03
#: Times the friction of its axis that a correction of friction, or a basis of structure in the model, may be worth.
MOST_FRICTION = 2.0
#: Share of the motor inertia of the robot file that a correction of it may be worth, beside that of friction.
MOTOR_INERTIA = 0.5
#: Times its first-order effect that the filter behind the derivatives may have.
FILTER = 3.0
#: Share by which the mass of one link may be wrong.
LINK_MASS = 0.25

# The model that is written.

#: Time in motion [s] from which a record is asked by itself.
ASKED_ALONE = 5.0
#: Share of its prior variance that is left of a coefficient that the data tell of.
TOLD = 0.1
#: Multiple of the margin over the given robot that is left to an axis where all that would mend it harms others.
SPARED = 1.5
#: Relative error of the drive parameters up to which they are taken as right, and tell a reference temperature.
RIGHT_PARAMETERS = 0.03
