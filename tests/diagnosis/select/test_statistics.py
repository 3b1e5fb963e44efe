"""How sure an improvement is, what it is on held-out windows, and the probabilities that follow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.confirm.held_out import Gain, gain
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.hypothesis.significance import likelihood_significance
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.choice import least_gain
from greybox_torch.diagnosis.select.posterior import (
    believed,
    by_comparison,
    of_a_stopped_search,
    shared,
)
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction
from greybox_torch.mechanisms.sensor import OutputDelay, SensorLag
from greybox_torch.mechanisms.torque_ripple import TorqueRipple

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()

SAMPLES = 20_000


@pytest.fixture
def fitted(stub):
    """A hypothesis of which only window energies are known."""

    def make(*energies, free=(), noise=0.0):
        fits = tuple(
            stub(energies=np.asarray(e, dtype=float), mean_square=float(np.mean(e)), windows=stub(steps=10 * 4**k))
            for k, e in enumerate(energies)
        )
        y = noise * np.random.default_rng(5).normal(size=(1, SAMPLES))
        records = stub(
            y=y, u=y, first=np.array([0]), span=lambda e: slice(0, SAMPLES), time=lambda e: np.arange(SAMPLES)
        )
        problem = stub(free_names=free, records=records, weights=np.ones(1), most_noise=None)
        return stub(fits=fits, problem=problem, score=float(np.log(np.mean(energies[0]))))

    return make


def energies(seed: int, count: int = 64, samples: int = 100) -> np.ndarray:
    """Energies of windows of noise."""
    return np.random.default_rng(seed).chisquare(samples, count) / samples


def test_share_that_is_gained_on_held_out_windows(fitted) -> None:
    before, after = fitted([4.0, 6.0, 10.0]).fits, fitted([1.0, 2.0, 3.0]).fits
    assert gain(before, after).share == pytest.approx(14 / 20)
    scaled = gain(fitted([40.0, 60.0, 100.0]).fits, fitted([10.0, 20.0, 30.0]).fits)
    assert scaled.share == pytest.approx(14 / 20)
    assert scaled.error == pytest.approx(gain(before, after).error)


def test_standard_error_of_the_share_is_that_of_repeats(fitted) -> None:
    def one(seed: int) -> Gain:
        before = 1.0 + 0.2 * np.random.default_rng(seed).normal(size=40)
        return gain(fitted(before).fits, fitted(before - 0.1 * np.random.default_rng(seed + 500).normal(1, 3, 40)).fits)

    gains = [one(seed) for seed in range(300)]
    assert np.mean([g.error for g in gains]) == pytest.approx(np.std([g.share for g in gains]), rel=0.15)
    low, high = gains[0].interval
    assert high - low == pytest.approx(2 * 1.96 * gains[0].error)


def test_one_window_or_none_is_no_evidence(fitted) -> None:
    assert gain(fitted([4.0]).fits, fitted([1.0]).fits) == Gain(0.75, float("inf"))
    assert gain((), ()) == Gain(0.0, float("inf"))


def test_length_that_is_surest_counts(fitted) -> None:
    noisy, clear = ([9.0, 1.0, 5.0], [1.0, 5.0, 4.0]), ([4.0, 5.0, 6.0], [1.0, 2.1, 2.9])
    both = gain(fitted(noisy[0], clear[0]).fits, fitted(noisy[1], clear[1]).fits)
    assert both == gain(fitted(clear[0]).fits, fitted(clear[1]).fits)


def test_windows_are_compared_with_those_of_the_same_length(fitted) -> None:
    """Seen: a knee's spring, without which short windows of a leg overflow: it gained nothing, was taken back, and gravity named (0.97)."""
    before, after = fitted([5.0, 6.0], [400.0, 500.0, 600.0]).fits, fitted([0.1, 0.2], [1.0, 1.0, 1.0]).fits
    assert gain(before[1:], after) == gain(before[1:], after[1:])
    assert gain(before[1:], after).share == pytest.approx(1.0 - 3.0 / 1500.0)
    assert gain(before[:1], after[1:]) == Gain(1.0, 0.0), "nothing is simulated without it where it is with it"


def ranked(mechanism, fitted, gained: float, window_energies, port="rotor", size=1, noise=0.0) -> RankedCandidate:
    attachment = Attachment(port, mechanism)
    free = tuple(f"{attachment.prefix}.size_{k}" for k in range(size))
    return RankedCandidate(
        Candidate(attachment, (), 0.5), fitted(window_energies, free=free, noise=noise), gained, 10.0
    )


def test_equal_rivals_share_equally(fitted) -> None:
    same = energies(0)
    chosen, twin = ranked(ConstantBias(), fitted, 1.0, same), ranked(CoulombAsymmetry(), fitted, 1.0, same)
    probability, alternatives = shared(chosen, [chosen, twin], SETTINGS)
    assert probability == pytest.approx(SETTINGS.highest_probability / 2, abs=1e-3)
    assert [(a.mechanism, a.probability) for a in alternatives] == [("coulomb_asymmetry", probability)]


def test_beliefs_weigh_rivals_by_their_odds(fitted) -> None:
    same = energies(0)
    chosen, twin = ranked(ConstantBias(), fitted, 1.0, same), ranked(CoulombAsymmetry(), fitted, 1.0, same)
    beliefs = Beliefs({"rotor/coulomb_asymmetry": 0.9})
    assert believed(chosen, [chosen, twin], SETTINGS, beliefs) is twin
    assert believed(chosen, [chosen, twin], SETTINGS, NO_BELIEFS) is chosen
    assert believed(chosen, [chosen, twin], SETTINGS, Beliefs({"load/*": 0.9})) is chosen
    own, (only,) = shared(twin, [chosen, twin], SETTINGS, beliefs, chosen)
    assert own / only.probability == pytest.approx(9.0, rel=1e-2)
    assert own + only.probability == pytest.approx(SETTINGS.highest_probability, abs=1e-3)


def test_beliefs_do_not_outweigh_what_recordings_say(fitted) -> None:
    """The weight of a rival is that of the recordings times its odds, whichever of the two is in the model."""
    same = energies(0)
    best, far = ranked(ConstantBias(), fitted, 1.0, same), ranked(CoulombFriction(), fitted, 0.5, 3.0 * same)
    beliefs = Beliefs({"rotor/coulomb_friction": 0.9})
    assert believed(best, [best, far], SETTINGS, beliefs) is best
    assert shared(far, [best, far], SETTINGS, beliefs, best)[0] < 0.01


def test_a_far_rival_gets_none(fitted) -> None:
    same = energies(0)
    chosen, far = ranked(ConstantBias(), fitted, 1.0, same), ranked(CoulombFriction(), fitted, 0.5, 3.0 * same)
    useless = ranked(CoulombAsymmetry(), fitted, -0.1, same)
    assert shared(chosen, [chosen, far, useless], SETTINGS) == (SETTINGS.highest_probability, ())


def test_the_same_mechanism_at_another_order_is_no_rival_but_at_another_port_is(fitted) -> None:
    same = energies(0)
    chosen = ranked(TorqueRipple(4.0), fitted, 1.0, same)
    assert (
        shared(chosen, [chosen, ranked(TorqueRipple(5.0), fitted, 1.0, same)], SETTINGS)[0]
        == SETTINGS.highest_probability
    )
    elsewhere = ranked(TorqueRipple(4.0), fitted, 1.0, same, port="load")
    probability, alternatives = shared(chosen, [chosen, elsewhere], SETTINGS)
    assert [(a.port, a.mechanism) for a in alternatives] == [("load", "torque_ripple")]
    assert probability + alternatives[0].probability == pytest.approx(SETTINGS.highest_probability, abs=1e-3)


def test_what_makes_a_model_simulate_gains_everything(fitted) -> None:
    """Seen: a hysteretic spring, refitted without the bias beside it, overflowed on held-out windows; the bias was taken back."""
    fits = fitted(energies(1)).fits
    assert gain((), fits).share == 1.0 and gain((), fits).errors_away > 1e6
    assert gain(fits, ()).errors_away == 0.0


def test_a_stopped_search_is_not_sure() -> None:
    """Of a curve, in the place of which names may not have been tried, less than of a name; of a class as sure as before."""
    curve = Effect("motor", "unknown", 0.97, ("speed",), "", {}, 0.5, (), None)
    shares = (Alternative("gear_spring", "backlash", 0.9), Alternative("gear_spring", "end_stop", 0.06))
    whole = OneOf("a gap at gear_spring", 0.96, shares)
    named = replace(curve, mechanism="backlash", port="gear_spring", probability=0.9, one_of=whole)
    unsure = replace(named, probability=0.3, one_of=None)
    less, at_most, same = of_a_stopped_search((curve, named, unsure), SETTINGS)
    assert less.probability == 0.5 and same == unsure
    assert at_most.probability == 0.85 and at_most.one_of is not None and at_most.one_of.probability == 0.96
    assert [m.probability for m in at_most.one_of.members] == [0.85, 0.06]


@pytest.mark.parametrize(("noise", "first"), [(1.0, "coulomb_asymmetry"), (0.1, "constant_bias")])
def test_at_the_noise_likelihood_tells_laws_apart_that_windows_do_not(fitted, noise, first) -> None:
    """Seen: an asymmetry of friction taken for a bias, 90 in twice the log likelihood behind for one parameter less."""
    level = noise**2 if noise == 1.0 else 1.0  # of the error; the second is far above its noise
    same, jitter = level * energies(0), np.random.default_rng(1).normal(1.0, 0.02, 64)
    less = same * jitter * 0.9975 * same.mean() / (same * jitter).mean()
    small = ranked(ConstantBias(), fitted, 1.0, same, noise=noise)
    large = ranked(CoulombAsymmetry(), fitted, 1.0, less, size=2, noise=noise)
    assert in_order([small, large], SETTINGS)[0].candidate.attachment.mechanism.name == first
    away = likelihood_significance(small.fitted, large.fitted, SETTINGS)
    assert away == pytest.approx(np.sqrt(-SAMPLES * np.log(0.9975)) if noise == 1.0 else 0.0)
    assert (shared(large, [large, small], SETTINGS)[0] > 0.9) == (noise == 1.0)


def test_where_much_is_left_more_has_to_be_gained(fitted) -> None:
    assert least_gain(fitted(energies(0), noise=1.0), SETTINGS) == SETTINGS.least_gain
    assert least_gain(fitted(16.0 * energies(0), noise=1.0), SETTINGS) == SETTINGS.least_gain_far_above_noise


def test_where_the_noise_is_not_known_more_has_to_be_gained(fitted) -> None:
    """Seen: a circuit's complete model, errors below what its smooth record allows as noise, and 2 % less of them by a drag."""
    smooth = fitted(1e-6 * energies(0), noise=1.0)
    smooth.problem.records.y[:] = np.sin(0.3 * np.arange(SAMPLES))
    assert least_gain(smooth, SETTINGS) == SETTINGS.least_gain_far_above_noise


def test_a_delay_of_the_input_is_a_delay_of_the_output(fitted) -> None:
    """They commute with any machine that does not change with time; only how they are computed sets their fits apart."""
    same = energies(0)
    chosen = ranked(InputDelay(), fitted, 1.0, same, port="actuator", noise=1.0)
    twin = ranked(OutputDelay(), fitted, 1.0, 1.01 * same, port="sensor", noise=1.0)
    probability, alternatives = shared(chosen, [chosen, twin], SETTINGS)
    assert probability == pytest.approx(SETTINGS.highest_probability / 2, abs=1e-3) and len(alternatives) == 1
    lag = ranked(SensorLag(), fitted, 1.0, 1.01 * same, port="sensor", noise=1.0)
    assert shared(chosen, [chosen, lag], SETTINGS)[0] > 0.9
    chosen.fitted.problem.records.y = np.repeat(
        chosen.fitted.problem.records.y, 2, axis=0
    )  # another sensor sees no delay
    assert shared(chosen, [chosen, twin], SETTINGS)[0] > 0.9


def test_an_effect_whose_rivals_are_not_on_record_is_as_sure_as_its_comparison(fitted) -> None:
    """What it does to the windows decides, not a constant."""
    before = fitted(np.full(40, 1.0))
    rng = np.random.default_rng(0)
    better, alike = fitted(0.2 * rng.uniform(0.9, 1.1, 40)), fitted(rng.uniform(0.9, 1.1, 40))
    assert by_comparison(before, better, SETTINGS) == SETTINGS.highest_probability
    assert by_comparison(before, alike, SETTINGS) < 0.7
