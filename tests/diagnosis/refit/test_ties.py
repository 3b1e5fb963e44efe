"""Named hypotheses that fit windows alike, told apart on whole records."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.refit import ties
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged
from greybox_torch.diagnosis.refit.ties import rank_by_likelihood
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.posterior import shared
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.actuator import InputBias
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.unknown import Unknown

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()

SAMPLES = 20_000


@pytest.fixture
def ranked(stub) -> Callable[..., RankedCandidate]:
    """A hypothesis of which only the error over windows is known, in units of the noise, and how many parameters its law has."""

    def make(mechanism, error: float, size: int = 1) -> RankedCandidate:
        attachment = Attachment("rotor", mechanism)
        y = np.random.default_rng(5).normal(size=(1, SAMPLES))
        records = stub(
            y=y, u=y, first=np.array([0]), span=lambda e: slice(0, SAMPLES), time=lambda e: np.arange(SAMPLES)
        )
        free = tuple(f"{attachment.prefix}.size_{k}" for k in range(size))
        fit = stub(energies=np.full(64, error), mean_square=error)
        problem = stub(free_names=free, records=records, weights=np.ones(1), most_noise=None)
        return RankedCandidate(
            Candidate(attachment, (), 0.5), stub(fits=(fit,), problem=problem, score=float(np.log(error))), 1.0, 9.0
        )

    return make


def names(found: list[RankedCandidate]) -> list[str]:
    return [r.candidate.attachment.mechanism.name for r in found]


def costing(monkeypatch, **costs: float) -> None:
    monkeypatch.setattr(ties, "cost_of", lambda fitted: costs[fitted.problem.free_names[0].split(".")[1]])


@pytest.mark.parametrize(("gravity", "first"), [(98.0, "constant_bias"), (90.0, "gravity")])
def test_a_parameter_more_must_be_worth_its_price(monkeypatch, ranked, gravity, first) -> None:
    """Seen: a gain of 1.02 called gravity, whose second parameter took up a drift."""
    costing(monkeypatch, constant_bias=100.0, gravity=gravity)
    order = [ranked(Gravity(), 0.996, 2), ranked(ConstantBias(), 1.0)]
    found = rank_by_likelihood(order, SETTINGS, BUDGET)
    assert names(found)[0] == first
    assert {r.cost for r in found} == {100.0, gravity}


@pytest.mark.parametrize(("further", "first"), [(0.5, "constant_bias"), (1.5, "gravity")])
def test_odds_below_three_are_no_reason_for_a_parameter_more(monkeypatch, ranked, further, first) -> None:
    """Seen: the gain of a cart's drive told as a mode (0.96), whose two further parameters were worth half a nat more than their price."""
    price = 0.5 * np.log(SAMPLES)
    costing(monkeypatch, constant_bias=100.0, gravity=100.0 - price - further)
    found = rank_by_likelihood([ranked(Gravity(), 0.996, 2), ranked(ConstantBias(), 1.0)], SETTINGS, BUDGET)
    assert names(found)[0] == first


def test_further_parameters_have_the_same_price_in_the_probability(monkeypatch, ranked) -> None:
    price = 0.5 * np.log(SAMPLES)
    chosen, rival = (
        replace(ranked(Gravity(), 0.996, 2), cost=100.0 - price - 1.5),
        replace(ranked(ConstantBias(), 1.0), cost=100.0),
    )
    assert 0.4 < shared(chosen, [chosen, rival], SETTINGS)[0] < 0.75
    assert shared(replace(chosen, cost=80.0 - price), [chosen, rival], SETTINGS)[0] > 0.95


def test_what_does_not_tie_keeps_its_place_and_so_do_curves_and_what_goes_astray(monkeypatch, ranked) -> None:
    costing(monkeypatch, constant_bias=100.0, gravity=1e6, torque_ripple=0.0)
    curve, worse = ranked(Unknown("speed"), 0.99, 14), ranked(TorqueRipple(), 1.2, 3)
    found = rank_by_likelihood(
        [curve, ranked(Gravity(), 0.996, 2), ranked(ConstantBias(), 1.0), worse], SETTINGS, BUDGET
    )
    assert names(found) == ["unknown", "gravity", "constant_bias", "torque_ripple"]
    assert [r.cost for r in found] == [None, None, 100.0, None]
    costing(monkeypatch, constant_bias=100.0, gravity=120.0)
    found = rank_by_likelihood(
        [curve, ranked(Gravity(), 0.996, 2), ranked(ConstantBias(), 1.0), worse], SETTINGS, BUDGET
    )
    assert names(found) == ["unknown", "constant_bias", "gravity", "torque_ripple"]


def test_a_free_run_beyond_the_tie_counts_as_far_behind_as_the_tie_goes(monkeypatch, ranked) -> None:
    """Seen: a rival whose whole records were 32 nats worse weighed 0.24 by its windows, one 21 nats worse 0.005."""
    edge = 100.0 + 0.5 * SETTINGS.score_tie * SAMPLES
    order = [ranked(ConstantBias(), 1.0), ranked(Gravity(), 1.0001)]
    own = []
    for cost in (110.0, edge - 1.0, edge + 1.0, edge + 2000.0):
        costing(monkeypatch, constant_bias=100.0, gravity=cost)
        chosen, rival = rank_by_likelihood(order, SETTINGS, BUDGET)
        assert (chosen.cost, rival.cost) == (100.0, min(cost, edge))
        own.append(shared(chosen, [chosen, rival], SETTINGS)[0])
    assert own == sorted(own) and own[-1] > 0.96
    costing(monkeypatch, constant_bias=edge + 1.0, gravity=100.0)
    assert [r.cost for r in rank_by_likelihood(order, SETTINGS, BUDGET)] == [None, 100.0]


def test_above_the_noise_and_alone_nothing_is_weighed(ranked) -> None:
    loud = [ranked(Gravity(), 3.0, 2), ranked(ConstantBias(), 3.0)]
    alone = [ranked(Gravity(), 1.0, 2)]
    assert (
        rank_by_likelihood(loud, SETTINGS, BUDGET) == loud
        and rank_by_likelihood(alone, SETTINGS, BUDGET) == alone
        and rank_by_likelihood([], SETTINGS, BUDGET) == []
    )


def test_the_probability_is_shared_by_likelihood(ranked) -> None:
    chosen, rival = replace(ranked(ConstantBias(), 1.0), cost=100.0), ranked(Gravity(), 0.996)
    even, behind, far = (shared(chosen, [chosen, replace(rival, cost=c)], SETTINGS)[0] for c in (100.0, 101.6, 140.0))
    assert even == pytest.approx(SETTINGS.highest_probability / 2, abs=1e-3) and even < behind < far == pytest.approx(
        SETTINGS.highest_probability, abs=1e-3
    )


def test_one_law_by_two_names_is_equally_likely_on_a_machine_that_drifts(motor_data, motor, begun) -> None:
    """A constant voltage, beside a slow one that is on no record, is a constant torque."""
    drift = 0.01 * np.sin(np.linspace(0.0, 9.0, 2000))
    search = begun(motor_data(acting=lambda v: v + 0.3 + drift, noise=0.05), motor)
    laws = []
    for port, mechanism in (("rotor", ConstantBias()), ("actuator", InputBias())):
        attachment = attach(motor, port, mechanism)
        fitted = search.refitted((attachment,), search.plain)
        assert fitted is not None
        laws.append(judged(Candidate(attachment, (), 0.5), search.plain, fitted, SETTINGS))
    one, other = rank_by_likelihood(laws, SETTINGS, BUDGET)
    assert one.cost is not None and other.cost == pytest.approx(one.cost, abs=0.5)
    assert shared(one, [one, other], SETTINGS)[0] == pytest.approx(SETTINGS.highest_probability / 2, abs=0.05)
