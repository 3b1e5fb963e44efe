"""How sure a name is, by what all findings together leave."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.select.all_that_is_left import (
    LeftInFreeRuns,
    limited_by_a_curve,
    limited_by_a_larger_rest,
    limited_by_a_poor_fit,
    limited_by_others_at_its_port,
    limited_by_what_is_left,
    lowest_limit,
    sizes_at,
)
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS, SAMPLES = DiagnosisSettings(), 20_000


def claimed_of(probability: float, *left: Any, **how: Any) -> float:
    limit = limited_by_what_is_left(*left, **how)
    return probability if limit is None else min(probability, limit.highest)


@pytest.fixture
def left_much(stub) -> Any:
    """Hypotheses that leave a mean squared error over noise of a hundredth."""
    y = 0.1 * np.random.default_rng(5).normal(size=(1, SAMPLES))
    records = stub(y=y, u=y, first=np.array([0]), span=lambda e: slice(0, SAMPLES), time=lambda e: np.arange(SAMPLES))
    problem = stub(records=records, weights=np.ones(1), most_noise=None)
    return lambda error: stub(fits=(stub(mean_square=error),), problem=problem)


def test_a_name_is_less_sure_the_more_is_left_with_it(left_much) -> None:
    """Seen: dry friction at the wrong port, 0.85, which left 82 times the noise and four fifths of the mismatch."""
    much, little = left_much(1.0), left_much(0.011)
    assert [claimed_of(0.97, share, much, SETTINGS) for share in (0.01, 0.3, 0.8)] == [0.97, 0.85, 0.5]
    assert claimed_of(0.3, 0.8, much, SETTINGS) == 0.3
    assert claimed_of(0.97, 0.8, little, SETTINGS) == 0.97, "near the noise"
    worse, far_worse = LeftInFreeRuns(of_mismatch=0.5), LeftInFreeRuns(of_mismatch=0.9)
    free_runs = [claimed_of(0.97, 0.01, much, SETTINGS, left) for left in (worse, far_worse)]
    assert free_runs == [0.97, 0.97], "over windows next to nothing is left"
    assert claimed_of(0.97, 0.3, much, SETTINGS, far_worse) == 0.5
    assert claimed_of(0.97, 0.3, much, SETTINGS, far_worse, free=True) == 0.97, "a curve may be a part"
    assert claimed_of(0.97, 0.3, little, SETTINGS, far_worse) == 0.97


@pytest.mark.parametrize(("in_free_runs", "claimed"), [(None, 0.5), (0.01, 0.85), (0.3, 0.85), (0.4, 0.5)])
def test_where_free_runs_leave_little_windows_alone_do_not_say_that_most_is_left(
    left_much, in_free_runs: float | None, claimed: float
) -> None:
    """Seen: the damping of a pendulum's arm on real recordings, 0.50, whose law leaves a hundred-thousandth in free runs."""
    left = LeftInFreeRuns(of_mismatch=in_free_runs)
    assert claimed_of(0.97, 0.9, left_much(1.0), SETTINGS, left) == claimed


@pytest.mark.parametrize("free", [False, True])
def test_no_finding_is_sure_where_free_runs_follow_little_of_what_was_measured(left_much, free: bool) -> None:
    """Seen: a cogging motor under control, told with a lag and a mode (0.85) and a curve (0.97), none of them known of; a fit of 53 %."""
    much, little = left_much(1.0), left_much(0.011)
    followed, missed = LeftInFreeRuns(of_measured=0.1), LeftInFreeRuns(of_measured=0.2)
    assert claimed_of(0.97, 0.3, much, SETTINGS, followed, free=free) == (0.97 if free else 0.85)
    assert claimed_of(0.97, 0.3, much, SETTINGS, missed, free=free) == 0.5
    assert claimed_of(0.97, 0.3, little, SETTINGS, missed, free=free) == 0.97, "what they miss is noise"
    limit = limited_by_what_is_left(0.3, much, SETTINGS, missed, free=free)
    assert limit is not None and "miss 20 % of the variance of what was measured" in limit.why


@pytest.mark.parametrize(
    ("ceiling", "left", "highest"),
    [(0.8521, 0.065, 0.5), (0.6356, 0.001, None), (1.0, 0.081, None), (0.8, None, None), (None, 0.2, None)],
    ids=["an eddy-current brake", "the first of two effects", "no curve goes farther", "no free run tells", "no curve"],
)
def test_a_name_that_a_curve_outdoes_where_free_runs_leave_much_is_unsure(ceiling, left, highest) -> None:
    limit = limited_by_a_curve(ceiling, SETTINGS, LeftInFreeRuns(left))
    assert (None if limit is None else limit.highest) == highest
    if limit is not None:
        assert "85 % of what a free curve does in its place, and free runs leave 6.5 %" in limit.why


@pytest.mark.parametrize(
    ("size", "left", "highest"),
    [
        (0.19, LeftInFreeRuns(0.53, times_noise=3.1), 0.5),
        (0.86, LeftInFreeRuns(0.42, times_noise=6.9), None),
        (0.19, LeftInFreeRuns(0.53, times_noise=2.1), None),
        (np.nan, LeftInFreeRuns(0.53, times_noise=3.1), None),
        (0.19, LeftInFreeRuns(None, times_noise=3.1), None),
        (0.19, LeftInFreeRuns(0.53, times_noise=np.nan), None),
    ],
    ids=[
        "a part of more",
        "the larger part",
        "hardly more than noise",
        "nobody knows its size",
        "no free run tells",
        "nor the noise",
    ],
)
def test_less_than_is_left_is_even_odds_at_most(size, left, highest) -> None:
    """Seen: small laws of a complete strut, told as an end stop that is touched half of the time (0.97)."""
    limit = limited_by_a_larger_rest(size, left, SETTINGS)
    assert (None if limit is None else limit.highest) == highest
    if limit is not None:
        assert "19 % of the mismatch, of which free runs leave 53 %" in limit.why


@pytest.mark.parametrize(
    ("sizes", "left", "limited"),
    [
        ((0.14, 0.23, 0.06), LeftInFreeRuns(0.13, times_noise=2.9), True),
        ((0.23,), LeftInFreeRuns(0.13, times_noise=2.9), False),  # alone at its port
        ((0.14, 0.6), LeftInFreeRuns(0.13, times_noise=2.9), False),  # one of them stands for the mismatch
        ((0.14, 0.23), LeftInFreeRuns(0.03, times_noise=2.9), False),  # together they leave little
        ((0.14, 0.23), LeftInFreeRuns(0.13, times_noise=1.1), False),  # or hardly more than noise
        ((0.14, 0.23), LeftInFreeRuns(), False),  # no free run tells
        ((0.14, float("nan")), LeftInFreeRuns(0.13, times_noise=2.9), False),  # one of them may stand for it
        ((float("nan"), 0.14), LeftInFreeRuns(0.13, times_noise=2.9), False),
    ],
)
def test_several_parts_at_one_port_may_be_one_other_law(sizes, left, limited) -> None:
    """Seen: the losses of a coil's core, told as bristles, a stop and waves of the current (0.97 each)."""
    limit = limited_by_others_at_its_port(sizes, left, SETTINGS)
    assert (limit is not None) is limited
    if limit is not None:
        assert limit.highest == 0.5 and f"none of the {len(sizes)} effects at its port" in limit.why


def test_what_is_too_small_to_be_a_finding_is_no_part(stub) -> None:
    effects = [stub(prefix=p, port=port) for p, port in (("a.x", "a"), ("a.y", "a"), ("a.z", "a"), ("b.x", "b"))]
    by_effect = {"a.x": 0.45, "a.y": 0.01, "b.x": 0.3}
    found = sizes_at("a", stub(effects=effects), by_effect, SETTINGS)
    assert found[0] == 0.45 and np.isnan(found[1]) and len(found) == 2
    assert sizes_at("b", stub(effects=effects), by_effect, SETTINGS) == (0.3,)


def test_the_lowest_limit_counts(left_much) -> None:
    much, rest = left_much(1.0), LeftInFreeRuns(0.53, times_noise=3.1)
    by_noise = lowest_limit(0.3, much, SETTINGS, LeftInFreeRuns(), free=False, ceiling=None, size=0.9)
    assert by_noise is not None and by_noise.highest == SETTINGS.highest_probability_far_above_noise
    by_rest = lowest_limit(0.3, much, SETTINGS, rest, free=False, ceiling=None, size=0.19)
    assert by_rest is not None and "19 % of the mismatch" in by_rest.why
    assert lowest_limit(0.3, left_much(0.011), SETTINGS, LeftInFreeRuns(), free=False, ceiling=1.0, size=0.9) is None


def test_what_free_runs_chose_in_the_place_of_what_windows_preferred_has_even_odds_at_most(left_much) -> None:
    """Seen: a ship's righting arm, told as an end stop of the hull (0.97), 98.6 % of the validation experiment followed."""
    asked = (0.01, left_much(0.011), SETTINGS)
    limit = lowest_limit(*asked, LeftInFreeRuns(0.011, chose=True), free=False, ceiling=1.0, size=0.8)
    assert limit is not None and limit.highest == 0.5 and "no recording is left" in limit.why
    assert lowest_limit(*asked, LeftInFreeRuns(0.011), free=False, ceiling=1.0, size=0.8) is None


@pytest.mark.parametrize(
    ("mean_fit", "share", "times", "limited"),
    [
        (16.0, 0.33, 340.0, True),
        (53.0, 0.39, 70.0, True),
        (61.0, 0.39, 70.0, False),
        (-39.0, 0.08, 370.0, False),
        (53.0, 0.39, 9.0, False),
    ],
)
def test_a_name_that_free_runs_follow_poorly_with_has_even_odds(
    mean_fit: float, share: float, times: float, limited: bool
) -> None:
    """The multicopter and the trolley; beside them a good fit, a waved rail of which 8 % is left, and a rest near the noise."""
    limit = limited_by_a_poor_fit(LeftInFreeRuns(share, times_noise=times, mean_fit=mean_fit), SETTINGS)
    assert (limit is not None) == limited
    if limit is not None:
        assert limit.highest == 0.5
        assert limit.why.startswith(f"free runs follow the validation experiments to {mean_fit:.2g} % on the average")
