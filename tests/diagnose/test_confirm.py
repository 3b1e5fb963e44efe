"""What held-out experiments make of a finding."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnose.candidates import attach
from greybox_torch.diagnose.confirm import _simplified
from greybox_torch.diagnose.held_out import held_out_fits
from greybox_torch.diagnose.leaders import Leader
from greybox_torch.diagnose.name import judged
from greybox_torch.diagnose.rounds import Round
from greybox_torch.diagnose.select import Search
from greybox_torch.estimate.problem import all_starts_free, make_problem
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
            ranked.append(judged(Leader(effect, (), 0.9), search.plain, fitted))
        search.rounds = [Round((), search.plain, tuple(ranked), ranked[0])]
        search.current = ranked[0].fitted
        others = all_starts_free(data, make_problem(data, motor, data.validation()))
        return search, partial(held_out_fits, problem=others, substeps=1)

    return make


@pytest.mark.parametrize(("extra", "meant"), [(0.0, "coulomb_friction"), (0.1, "stribeck_friction")])
def test_the_contained_law_is_meant_where_the_larger_one_predicts_no_better(chose_stribeck, extra, meant) -> None:
    search, on_others = chose_stribeck(extra)
    _simplified(search, on_others)
    (effect,) = search.current.effects
    assert effect.mechanism.name == meant
    assert search.rounds[0].taken.leader.attachment.mechanism.name == meant
    assert search.round_of(effect.prefix) is search.rounds[0]
