"""Thresholds below which what is missing is a matter of simulating, sampling, calibrating or rounding, not of physics."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import share


@dataclass(frozen=True, kw_only=True)
class SamplingSettings:
    """What simulations of one machine differ by, and when within its interval a sample may have been taken."""

    least_mismatch: float = share(
        3e-5,
        "Error of the plain model beyond the noise below which nothing is looked for: simulations of one machine differ by as much.",
        unit="share of the outputs' spread (root mean square)",
        chosen_by="the difference between simulators of first and of fourth order at usual steps",
    )
    least_shift: float = share(
        0.05,
        "Shift in time that is not told as missing physics, where its error is small and above the noise: no recording is timed better.",
        unit="sampling intervals",
        chosen_by="a simulator of first order is late by half its step, usually a twentieth of an interval",
    )
    most_of_shift: float = share(
        1e-3,
        "Error of the plain model beyond the noise up to which such a shift may account for it.",
        unit="share of the outputs' spread (root mean square)",
        chosen_by="a fit of 99.9 %",
    )
    left_by_shift: float = share(
        0.5,
        "Part of what is beyond the noise that the best shift in time of every output may leave for the error to be told as one.",
        unit="share of the squared error beyond the noise",
        chosen_by="a simulator of first order is late and damps a little otherwise; play of a nut is no shift at all (0.97 left)",
    )
    no_shift: float = share(
        0.1,
        "Shift in time below which a lag or a delay is never a finding, however far above the noise: no drive is timed so well.",
        unit="sampling intervals",
        chosen_by="an axis whose torque rises over a tenth of an interval: 0.026; concealed lags and delays begin at 0.16",
    )
    shortest_shift: float = share(
        0.25,
        "Shift in time from which a lag or a delay is a finding near the noise: a sensor's filter and an input's edge may be as late.",
        unit="sampling intervals",
        chosen_by="a filter of a fifth of a sample and an edge of a twentieth; delays that were concealed last half a sample and more",
    )
    shift_of_a_hold: float = share(
        0.5,
        "The same where it does not account for nearly all of what is missing: an input that changes over the interval is as late.",
        unit="sampling intervals",
        chosen_by="the mean delay of an input that is interpolated where the card says that it is held",
    )
    nearly_all: float = share(
        0.9,
        "Size from which a shift in time accounts for nearly all that is missing.",
        unit="share of the plain model's held-out mismatch",
        chosen_by="concealed shifts of less than half a sample near the noise: 0.97 to 1; a complete reactor's: 0.72",
    )
    smallest_gain_error: float = share(
        3e-3,
        "Error of a gain from which it is a finding near the noise: sensors and drives are hardly calibrated better.",
        unit="share of the gain",
        chosen_by="concealed errors of gains near the noise: 0.41 % and more; of complete machines: 0.07 and 0.16 %",
    )
    own_friction: float = share(
        0.3,
        "Level of the dry friction that a model has at a body, from which more of it there is no finding near the noise: the two are one.",
        unit="share of the level that is found",
        chosen_by="a complete mixer's rollers: as much as is found",
    )
    part_of_steps: float = share(
        0.3,
        "Part of the error of free runs that finer steps have to move for the final fits to take them.",
        unit="share of the root mean square error",
        chosen_by="a tenth of the squared error, as much as a small finding; a winch's friction in steps that were too long: 0.9",
    )
