"""At a free curve's port, laws are also compared in their richer forms."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.refit import behind_curve
from greybox_torch.diagnosis.refit.behind_curve import laws_behind_curve
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged, price_of_noise
from greybox_torch.diagnosis.refit.richer_forms import richer_forms
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction
from greybox_torch.mechanisms.unknown import Unknown


def uneven(q: float, v: float) -> float:
    """Dry friction of 0.09 N m forwards and 0.03 N m backwards."""
    return -0.06 * np.tanh(v / 0.3) - 0.03 * abs(np.tanh(v / 0.3))


def also_by_position(q: float, v: float) -> float:
    """The same and a force that friction is not."""
    return uneven(q, v) + 0.04 * np.tanh(2.0 * v - 1.0)


@pytest.fixture(scope="module")
def compared(motor_data, motor, begun):
    """A search, and a curve over the speed beside Coulomb friction, both refitted."""

    def make(torque: Any) -> tuple[Any, list[RankedCandidate]]:
        search = begun(motor_data(torque=torque), motor)
        curve, law = attach(motor, "rotor", Unknown("speed", 24)), attach(motor, "rotor", CoulombFriction())
        heights = {f"{curve.prefix}.w_{k}": 0.02 * (1 if k < 12 else -1) for k in range(24)}
        begins = (heights, {f"{law.prefix}.F_c": 0.05, f"{law.prefix}.v_0": 0.3})
        ranked = []
        for effect, begin in zip((curve, law), begins, strict=True):
            fitted = search.refitted((effect,), search.plain, [search.plain.values() | begin])
            ranked.append(judged(Candidate(effect, (), 0.5), search.plain, fitted, search.study.settings))
        assert ranked[0].gain > ranked[1].gain / search.study.settings.named_share
        return search, ranked

    return make


def test_friction_that_differs_by_direction_is_compared_as_such(compared) -> None:
    """Seen: a voice coil's friction, five times as large one way, was told as damping of its flexure."""
    search, ranked = compared(uneven)
    behind = laws_behind_curve(search.study, search.plain, ranked, frozenset())
    (form,) = (r for r in behind if "rotor.coulomb_asymmetry.F_c" in r.fitted.values())
    values = form.fitted.values()
    assert values["rotor.coulomb_asymmetry.F_c"] == pytest.approx(0.06, rel=0.1)
    assert abs(values["rotor.coulomb_asymmetry.delta"]) == pytest.approx(0.03, rel=0.1)
    assert form.fitted.score < ranked[0].fitted.score + search.study.settings.score_tie


def test_a_form_that_does_not_come_as_far_as_the_curve_is_left_out(compared) -> None:
    search, ranked = compared(also_by_position)
    behind = laws_behind_curve(search.study, search.plain, ranked, frozenset())
    assert not [r for r in behind if "rotor.coulomb_asymmetry.F_c" in r.fitted.values()]


def test_where_a_curve_leads_by_the_noise_that_it_takes_up_no_form_is_compared(compared, monkeypatch) -> None:
    """Seen: a complete model and 255 samples; a curve led with 14 parameters, a ripple with 13 came as far and was told."""
    search, (curve, law) = compared(uneven)

    def named() -> list[str]:
        return [
            r.candidate.attachment.prefix
            for r in laws_behind_curve(search.study, search.plain, (curve, law), frozenset())
        ]

    assert named() == ["rotor.coulomb_asymmetry"]
    price = curve.gain / (curve.size - law.size)
    monkeypatch.setattr(behind_curve, "price_of_noise", lambda *_: price)
    assert named() == []


@pytest.mark.parametrize(("samples", "price"), [(1000, np.log(1000) / 1000), (0, 0.0)])
def test_a_parameter_costs_what_the_samples_say_where_noise_alone_is_left(
    compared, monkeypatch, samples, price
) -> None:
    search, _ = compared(uneven)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.ranked.white_samples", lambda *_: samples)
    assert price_of_noise(search.plain, search.study.settings) == pytest.approx(price)


def test_forms_are_those_of_laws_at_the_port_that_are_not_excluded(compared) -> None:
    search, (_, law) = compared(uneven)
    pairs = [
        (law.candidate, law.fitted),
        (Candidate(attach(search.problem.model, "rotor", ConstantBias()), (), 0.1), law.fitted),
    ]
    (form,) = richer_forms(search.study, "rotor", pairs)
    assert form.attachment.named == ("rotor", "coulomb_asymmetry") and form.explained == 0.5
    (begun,) = form.starts
    assert begun["rotor.coulomb_asymmetry.F_c"] == law.fitted.values()["rotor.coulomb_friction.F_c"]
    assert begun["rotor.coulomb_asymmetry.delta"] == 0.0 and not [n for n in begun if "coulomb_friction" in n]
    assert richer_forms(search.study, "load", pairs) == []
    excluded = replace(search.study, beliefs=Beliefs({"rotor/coulomb_asymmetry": 0.0}))
    assert richer_forms(excluded, "rotor", pairs) == []


def test_no_form_is_named_as_what_is_there_already(compared) -> None:
    """Seen: a second ripple in the form with harmonics of the first; the model named its parameters twice."""
    search, (_, law) = compared(uneven)
    uneven_already = attach(search.problem.model, "rotor", CoulombAsymmetry(with_level=True))
    both = search.refitted((uneven_already, law.candidate.attachment), search.plain)
    assert both is not None
    assert richer_forms(search.study, "rotor", [(law.candidate, both)]) == []


def test_beside_a_form_that_comes_as_far_as_the_curve_nearer_laws_are_asked_in_theirs(compared, monkeypatch) -> None:
    """Seen: a tendon's slack, told as a spring that runs into rubber (0.96): play had come nearer than the spring in its plain form."""
    search, (curve, law) = compared(uneven)
    nearer = replace(law, gain=0.99 * curve.gain)
    asked: list[list[RankedCandidate]] = []

    def forms(study: Any, port: str, laws: Any) -> list[Candidate]:
        asked.append([candidate for candidate, _ in laws])
        return richer_forms(study, port, laws)

    monkeypatch.setattr(behind_curve, "richer_forms", forms)
    laws_behind_curve(search.study, search.plain, [curve, law, nearer], frozenset())
    assert asked == [[law.candidate], [nearer.candidate]]
    asked.clear()
    laws_behind_curve(search.study, search.plain, [curve, nearer], frozenset())
    assert asked == [[]], "no form of another law is there"
