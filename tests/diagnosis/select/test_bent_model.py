"""Where the fit of the model as it stands is bent, the screen looks around the card's values, too."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.screen.shortlist import Candidate, with_card
from greybox_torch.diagnosis.select.bent_model import from_the_card, moved_far, narrowed, unbent_first
from greybox_torch.diagnosis.select.offered import from_card
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.surroundings import Range, Surroundings


def around(reach: float, rms: float = 1.0) -> dict[str, Surroundings]:
    ranges = {"speed": Range(-reach, 0.5 * reach, rms), "position": Range(0.0, 2.0, 1.0)}
    return {"bit": Surroundings(ranges, {"speed": "rad/s"}, "N m", 0.01)}


@pytest.mark.parametrize(("reach", "kept"), [(412.0, False), (74.0, True), (3.0, True)])
def test_a_range_is_the_cards_where_the_fit_moves_much_farther(reach, kept) -> None:
    """Seen: a drill bit that nobody measures, at 412 rad/s in the bent model and 25 rad/s with the card's values."""
    found = narrowed(around(reach), around(25.0), 3.0)["bit"]
    assert found.ranges["speed"] == around(reach if kept else 25.0)["bit"].ranges["speed"]
    assert found.ranges["position"] == Range(0.0, 2.0, 1.0) and found.units == {"speed": "rad/s"}


def test_a_signal_that_rests_with_the_cards_values_tells_no_range() -> None:
    assert narrowed(around(412.0), around(1e-15, rms=0.0), 3.0) == around(412.0)


def test_a_signal_that_the_cards_values_do_not_have_keeps_its_range() -> None:
    """Seen: a centrifuge's frame, which turned one way only at the card's values, so that no torque braked it there: a traceback."""
    found = around(412.0)
    found["bit"].ranges["along@torque"] = Range(-2.0, 3.0, 1.0)
    assert narrowed(found, around(25.0), 3.0)["bit"].ranges["along@torque"] == Range(-2.0, 3.0, 1.0)


def test_windows_with_the_cards_values_have_fitted_start_states_alone(dead_zone_search) -> None:
    study, state = dead_zone_search.study, dead_zone_search.state
    fits, ranges = from_the_card(study, state.plain)
    assert len(fits) == len(state.plain.fits) and ranges is not None
    for fit, plain in zip(fits, state.plain.fits, strict=True):
        np.testing.assert_array_equal(fit.problem.values, study.problem.values)
        np.testing.assert_array_equal(fit.problem.free, plain.problem.free)
        assert fit.windows.steps == plain.windows.steps and fit.mean_square > plain.mean_square
    assert set(ranges) == set(study.surroundings)


def test_what_the_card_shows_is_offered_with_the_cards_values_to_the_first_step_alone(dead_zone_search) -> None:
    study, state = dead_zone_search.study, dead_zone_search.state
    assert study.at_card == () and from_card(study, state) == []
    bent = replace(study, at_card=from_the_card(study, state.plain)[0])
    offered = from_card(bent, state)
    dead_zone = next(c for c in offered if c.attachment.named == ("actuator", "actuator_deadzone"))
    assert all(start[n] == v for start in dead_zone.starts for n, v in study.card.items())
    assert 0.2 < dead_zone.starts[0]["actuator.actuator_deadzone.half_width"] < 1.0, "0.5 V"
    assert from_card(bent, replace(state, current=replace(state.current, effects=(dead_zone.attachment,)))) == []


@pytest.mark.parametrize(("factor", "far"), [(1 / 85, True), (100.0, True), (0.1, False), (12.0, False), (0.0, False)])
def test_a_parameter_far_from_what_it_began_as_is_bent(dead_zone_search, factor: float, far: bool) -> None:
    """Seen: a lift's car with a hundredth of its mass. What is zero may be what the machine does not have."""
    problem = dead_zone_search.state.plain.problem
    values = problem.expected * np.where(np.arange(len(problem.values)) == np.flatnonzero(problem.free)[0], factor, 1.0)
    assert moved_far(problem.with_values(values), dead_zone_search.study.settings.bent_parameter) == far


@pytest.mark.parametrize(
    ("whole", "gain", "first"),
    [(True, 1.13, "arm"), (True, 0.9, "gearbox"), (False, 1.13, "gearbox")],
    ids=["nearly as far", "not as far", "bent as well"],
)
def test_a_law_that_bends_the_machine_goes_after_one_that_comes_nearly_as_far(
    dead_zone_search, stub, whole: bool, gain: float, first: str
) -> None:
    """Seen: an arm's friction told at its gearbox (0.97), with the spring between them thirty thousand times too soft."""
    problem, settings = dead_zone_search.state.plain.problem, dead_zone_search.study.settings
    factors = np.where(np.arange(len(problem.values)) == np.flatnonzero(problem.free)[0], 3e-5, 1.0)
    bent = problem.with_values(problem.expected * factors)
    unbent = problem.with_values(problem.expected) if whole else bent
    leader = stub(at="gearbox", unknown=False, gain=1.16, fitted=stub(problem=bent))
    curve = stub(at="curve", unknown=True, gain=1.15, fitted=stub(problem=unbent))
    rival = stub(at="arm", unknown=False, gain=gain, fitted=stub(problem=unbent))
    ranked = [leader, curve, rival]
    found = unbent_first(ranked, settings)
    assert found[0].at == first and {r.at for r in found} == {r.at for r in ranked} and len(found) == 3
    assert unbent_first([curve, leader, rival], settings) == [curve, leader, rival], "a curve leads"
    assert unbent_first([], settings) == []


def test_curves_are_offered_around_the_card_where_curves_are(dead_zone_search) -> None:
    study, state = dead_zone_search.study, dead_zone_search.state
    bent = replace(study, at_card=from_the_card(study, state.plain)[0])
    assert any(c.unknown for c in from_card(bent, state))
    assert not any(c.unknown for c in from_card(bent, state, curves=False))


def test_what_the_card_suggests_stands_beside_what_the_fit_does(motor) -> None:
    dry, zone = attach(motor, "rotor", CoulombFriction()), attach(motor, "actuator", ActuatorDeadzone())
    found = with_card(
        [Candidate(dry, ({"F_c": 1.0},), 0.5)],
        [Candidate(dry, ({"F_c": 2.0},), 0.9), Candidate(zone, ({"half_width": 0.1},), 0.4)],
    )
    assert [(c.attachment, c.starts, c.at_card) for c in found] == [
        (dry, ({"F_c": 1.0},), ({"F_c": 2.0},)),
        (zone, ({"half_width": 0.1},), ({"half_width": 0.1},)),
    ]


def test_a_trial_from_the_card_begins_with_its_start_states_and_goes_on_so_if_it_comes_farther(
    dead_zone_search, monkeypatch
) -> None:
    study, current, begun = dead_zone_search.study, dead_zone_search.state.current, []
    bent = replace(study, at_card=from_the_card(study, dead_zone_search.plain)[0])
    dry = attach(study.problem.model, "rotor", CoulombFriction())
    start = {f"{dry.prefix}.{name}": value for name, value in (("F_c", 0.1), ("v_0", 0.05))}

    def fit(study: Any, effects: Any, starts: Any, shorter: Any, *, at: Any = None, **how: Any) -> Any:
        begun.append((shorter is bent.at_card[0], bool(at), starts[0].get("from", "fit")))
        better = 0.2 if shorter is bent.at_card[0] else 0.6
        fits = current.fits[1:2] if at else current.fits
        return replace(current, fits=tuple(replace(f, mean_square=better * f.mean_square) for f in fits))

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank._pays", lambda study, ranked: True)
    steps = current.fits[1].windows.steps
    (ranked,) = rank(bent, current, [Candidate(dry, (start,), 0.3, steps=steps, at_card=({**start, "from": "card"},))])
    assert begun == [(False, True, "fit"), (True, True, "card"), (True, False, "fit")]
    assert ranked.fitted.fits[0].mean_square == pytest.approx(0.2 * current.fits[0].mean_square)
