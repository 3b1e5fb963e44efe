"""A free curve that was chosen beside what has gone since is asked for a name, however often choices were taken up before."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from greybox_torch.diagnosis.select import search as module
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.unknown import Unknown


@pytest.mark.parametrize("gone", [True, False])
def test_the_last_choice_may_be_what_a_curve_was_drawn_beside(dead_zone_search, motor, monkeypatch, gone: bool) -> None:
    """Seen: a platform's weight, told as a curve (0.97): it was drawn beside a sensor's gain, which the torque's gain replaced last."""
    begun, asked = dead_zone_search, []
    curve, bias = attach(motor, "rotor", Unknown("speed")), attach(motor, "rotor", ConstantBias())
    state = begun.at(begun.refitted((curve,), begun.plain)).state
    parent = replace(begun.plain, effects=(bias,) if gone else ())
    step = SimpleNamespace(taken=SimpleNamespace(candidate=SimpleNamespace(attachment=curve)), parent=parent)
    state = replace(state, steps=(step,))

    def same(study, given, *further):
        yield state
        return state

    def named(study, given, effect):
        asked.append(effect.prefix)
        yield given
        return given

    for name in ("explore", "drop_superfluous", "with_memory", "without_idle_bumps", "take_effects"):
        monkeypatch.setattr(module, name, same)
    monkeypatch.setattr(module, "only_parts", lambda study, state: False)
    monkeypatch.setattr(module, "_named_behind", named)
    study = replace(begun.study, budget=replace(begun.study.budget, most_revisions=0))
    assert result_of(search(study, begun.state)) is state
    assert asked == (["rotor.unknown"] if gone else [])
