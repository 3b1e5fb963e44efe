"""The most that is claimed for a finding, by what all findings together leave."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise, times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings


@dataclass(frozen=True)
class LeftInFreeRuns:
    """What all findings together leave in free runs of the validation experiments.

    ``of_mismatch``: share of the squared error of the model as it stands, None where no free run tells.
    ``of_measured``: mean squared error beyond the noise, in variances of what was measured. ``times_noise``: the largest error, in units
    of the noise. ``chose``: whether these free runs chose the findings in the place of what windows preferred. ``mean_fit``: in %.
    """

    of_mismatch: float | None = None
    of_measured: float = 0.0
    times_noise: float = 0.0
    chose: bool = False
    mean_fit: float = 100.0


@dataclass(frozen=True)
class Limit:
    """The highest probability that is claimed, and why, in words."""

    highest: float
    why: str


def lowest_limit(
    share: float,
    left: Hypothesis,
    settings: DiagnosisSettings,
    free_runs: LeftInFreeRuns,
    *,
    free: bool,
    ceiling: float | None,
    size: float,
    at_its_port: Sequence[float] = (),
) -> Limit | None:
    """What limits a finding most, of all that limits it; None where nothing does. Arguments as for the functions below."""
    return lowest(
        limited_by_what_is_left(share, left, settings, free_runs, free=free),
        limited_by_a_curve(ceiling, settings, free_runs),
        limited_by_a_larger_rest(size, free_runs, settings),
        limited_by_others_at_its_port(at_its_port, free_runs, settings),
        limited_by_its_choice(free_runs, settings),
        limited_by_a_poor_fit(free_runs, settings),
    )


def lowest(*limits: Limit | None) -> Limit | None:
    """The lowest of ``limits``, None where there is none."""
    return min((one for one in limits if one is not None), key=lambda one: one.highest, default=None)


def limited_by_what_is_left(
    share: float,
    left: Hypothesis,
    settings: DiagnosisSettings,
    free_runs: LeftInFreeRuns = LeftInFreeRuns(),
    *,
    free: bool = False,
) -> Limit | None:
    """What limits a finding where all findings together leave much more than noise, and more than a finding is; None elsewhere.

    Where that is most of the mismatch, what is named may be a part of what takes the place of the machine's own law. Where free runs miss
    much of what was measured, no law and no curve is known to be the machine's, however much better it is than none.

    Args:
        share: of the whole mismatch, that ``left`` leaves.
        free: whether it is a free curve, which no law of the machine can be mistaken for.
    """
    if not far_above_noise(left, settings) or share <= settings.least_size:
        return None
    if free_runs.of_measured > settings.most_of_measured:
        return Limit(
            settings.highest_probability_where_most_is_left,
            f"free runs of the validation experiments miss {100 * free_runs.of_measured:.2g} % of the variance of what was measured, where "
            f"a surer name needs at most {100 * settings.most_of_measured:.2g} %",
        )
    if free:
        return None
    if _most_is_left(share, free_runs.of_mismatch, settings):
        return Limit(
            settings.highest_probability_where_most_is_left, "most of the mismatch is left with all that was found"
        )
    return Limit(
        settings.highest_probability_far_above_noise,
        f"what is left with all that was found is {times_noise(left.problem, left, settings):.2g} times the noise",
    )


def limited_by_a_curve(
    ceiling: float | None, settings: DiagnosisSettings, free_runs: LeftInFreeRuns = LeftInFreeRuns()
) -> Limit | None:
    """What limits a name where a free curve in its place goes clearly farther, and free runs leave more than such a law may lack.

    Another law may then be meant, which the curve follows and the library may lack. Of the first of two effects the curve takes up the
    second as well; what both together leave is little then. Seen: an eddy-current brake's drag, told as an asymmetry (0.97), and a fan's
    thrust, told as gravity (0.85).

    Args:
        ceiling: share of the gain of the best free curve that the name reaches; None where no curve was fitted beside it.
    """
    left = free_runs.of_mismatch
    if ceiling is None or left is None or ceiling >= settings.as_far_as_a_curve or left <= settings.left_beside_a_curve:
        return None
    return Limit(
        settings.highest_probability_beside_a_curve,
        f"it reaches {100 * ceiling:.2g} % of what a free curve does in its place, and free runs leave {100 * left:.2g} % of the mismatch: "
        "another law may be meant",
    )


def limited_by_a_larger_rest(size: float, left: LeftInFreeRuns, settings: DiagnosisSettings) -> Limit | None:
    """What limits a finding that accounts for less of the mismatch than free runs leave with all that was found, far above the noise.

    Something larger than it is missing as well, and what is named may be a part of that. Seen: eleven small laws that a complete strut
    had and its model did not, told as an end stop that is touched half of the time (0.97), 19 % of the mismatch of which 53 % is left.

    Args:
        size: share of the mismatch that the finding accounts for; NaN where nobody knows.
    """
    if left.of_mismatch is None or not size < left.of_mismatch or not left.times_noise > settings.far_above_noise:
        return None
    return Limit(
        settings.highest_probability_where_most_is_left,
        f"it accounts for {100 * size:.2g} % of the mismatch, of which free runs leave {100 * left.of_mismatch:.2g} %",
    )


def sizes_at(
    port: str, state: SearchState, sizes: Mapping[str, float], settings: DiagnosisSettings
) -> tuple[float, ...]:
    """The ``sizes`` (by effect, shares of the mismatch) of the effects at a port, without those that are too small to be findings."""
    there = (sizes.get(e.prefix, float("nan")) for e in state.effects if e.port == port)
    return tuple(size for size in there if not size < settings.least_size)


def limited_by_others_at_its_port(
    sizes: Sequence[float], left: LeftInFreeRuns, settings: DiagnosisSettings
) -> Limit | None:
    """What limits each of several findings at one port none of which accounts for most of the mismatch, where free runs leave more.

    Together they draw what may be one law that the library lacks. Seen: the losses of a coil's core, told as bristles, a stop and waves of
    the current (0.97 each): 14, 23 and 6 % of the mismatch, of which 13 % was left.

    Args:
        sizes: shares of the mismatch that the findings at the port account for; nothing is claimed of one that nobody knows (NaN).
    """
    enough = left.of_mismatch is not None and left.of_mismatch > settings.left_beside_a_curve
    if len(sizes) < 2 or not enough or left.times_noise <= settings.above_noise:
        return None
    if not all(size < settings.most_of_the_mismatch for size in sizes):
        return None
    assert left.of_mismatch is not None
    return Limit(
        settings.highest_probability_where_most_is_left,
        f"none of the {len(sizes)} effects at its port accounts for most of the mismatch, of which free runs leave "
        f"{100 * left.of_mismatch:.2g} %: together they may stand for another law",
    )


def limited_by_a_poor_fit(left: LeftInFreeRuns, settings: DiagnosisSettings) -> Limit | None:
    """What limits findings with which free runs follow the validation experiments poorly on the average, and leave much of the mismatch,
    more than disturbances do; None for others.

    Something that is not found moves the machine as much as what is. Seen: a crane's trolley whose drive is limited, told as a sensor's lag
    (0.97) at a fit of 53 %, and a multicopter whose battery sags, told as that at one of 16 %.
    """
    share, enough = left.of_mismatch, 100.0 * (1.0 - settings.most_of_measured**0.5)
    if share is None or share <= settings.most_left_by_a_sure_name:
        return None
    if left.mean_fit >= enough or not left.times_noise > settings.far_above_disturbances:
        return None
    return Limit(
        settings.highest_probability_where_most_is_left,
        f"free runs follow the validation experiments to {max(left.mean_fit, 0.0):.2g} % on the average with it, where a surer name needs "
        f"{enough:.2g} %, and leave {100 * share:.2g} % of the mismatch",
    )


def limited_by_its_choice(free_runs: LeftInFreeRuns, settings: DiagnosisSettings) -> Limit | None:
    """What limits findings that free runs chose in the place of what windows preferred; None for others.

    Two ways to judge disagree, and no recording is left to decide. Seen: a ship's righting arm, told as an end stop of the hull (0.97) a
    fortieth as stiff as the righting arm itself, where windows preferred its stiffness with a friction that changes over time.
    """
    if not free_runs.chose:
        return None
    return Limit(
        settings.highest_probability_by_free_runs,
        "free runs of the validation experiments chose it in the place of what windows preferred, and no recording is left to bear it out",
    )


def _most_is_left(over_windows: float, in_free_runs: float | None, settings: DiagnosisSettings) -> bool:
    """Whether most of the mismatch is left: over windows of some length, unless little of it is left in free runs, or in these.

    Over short windows, where start states take up what is missing, what no model of a real machine has (a sensor's steps, a sampling that
    jitters) is most of the error. Seen: the damping of a pendulum's arm, 0.50, whose law leaves a hundred-thousandth in free runs.
    """
    if in_free_runs is None:
        return over_windows > settings.most_of_mismatch
    over_windows = over_windows if in_free_runs > settings.little_in_free_runs else 0.0
    return max(over_windows, in_free_runs) > settings.most_of_mismatch
