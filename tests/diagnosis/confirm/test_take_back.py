"""What held-out experiments make of a finding."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.take_back import _idle, _simplified
from greybox_torch.diagnosis.refit.rank import judged
from greybox_torch.diagnosis.screen.candidates import attach
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.forward_step import Round
from greybox_torch.diagnosis.select.search import Search
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction, StribeckFriction


@pytest.fixture
def chose_stribeck(motor_data, motor, begun) -> Any:
    """Makes a search that has taken Stribeck friction, Coulomb friction being its rival, and what judges it on other experiments."""

    def make(extra: float) -> tuple[Search, Any]:
        def friction(q: float, v: float) -> float:
            return -(0.05 + extra * np.exp(-((v / 0.8) ** 2))) * np.tanh(v / 0.1)

        data = motor_data(torque=friction)
        search, laws = begun(data, motor), (StribeckFriction(), CoulombFriction())
        ranked = []
        for law in laws:
            effect = attach(motor, "rotor", law)
            sizes = {f"{effect.prefix}.{n}": v for n, v in (("F_c", 0.04), ("F_s", 0.02), ("v_0", 0.1), ("v_s", 0.8))}
            fitted = search._refitted((effect,), search.plain, [{**search.plain.values(), **sizes}])
            assert fitted is not None
            ranked.append(judged(Candidate(effect, (), 0.9), search.plain, fitted))
        search.rounds = [Round((), search.plain, tuple(ranked), ranked[0])]
        search.current = ranked[0].fitted
        return search, HeldOut(data, search.problem, 1)

    return make


@pytest.mark.parametrize(("extra", "meant"), [(0.0, "coulomb_friction"), (0.1, "stribeck_friction")])
def test_the_contained_law_is_meant_where_the_larger_one_predicts_no_better(chose_stribeck, extra, meant) -> None:
    search, others = chose_stribeck(extra)
    _simplified(search, others)
    (effect,) = search.current.effects
    assert effect.mechanism.name == meant
    assert search.rounds[0].taken.leader.attachment.mechanism.name == meant
    assert search.round_of(effect.prefix) is search.rounds[0]


@pytest.mark.parametrize("elsewhere_too", [True, False])
def test_what_only_frees_the_other_parameters_is_idle_on_other_experiments(
    motor_data, motor, begun, elsewhere_too
) -> None:
    """A bias of one experiment: with it the other parameters are right, so it predicts others better than the model without."""
    biased = motor_data(torque=lambda q, v: 0.1)
    others = biased if elsewhere_too else motor_data(torque=lambda q, v: 0.0)
    recordings = (biased.recordings[0], others.recordings[1])
    data = replace(biased, recordings=recordings)
    search, effect = begun(data, motor), attach(motor, "rotor", ConstantBias())
    search.current = search._refitted((effect,), search.plain)
    search.without = {effect.prefix: search.plain}
    held_out = HeldOut(data, search.problem, 1)
    found = _idle(search, {effect.prefix: Gain(0.5, 0.1)}, held_out.fits(search.current), held_out)
    assert found == (None if elsewhere_too else effect.prefix)
    assert _idle(search, {effect.prefix: Gain(0.95, 0.1)}, held_out.fits(search.current), held_out) is None
