"""Final fits are made in as many steps per sample as free runs need."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis import final as final_fits
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.hypothesis.steps_of_whole_records import in_steps_for_whole_records
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.stored import restored_model, stored_effects

from ..conftest import STEP, Begun, turned

LEVEL = 0.05
"""N m."""


def with_friction(data_set, motor, begun, width: float, fine: int = 64) -> Begun:
    """A motor whose dry friction changes its sign within ``width`` rad/s, and a search that has it, begun at what is true."""
    rng, recorded = np.random.default_rng(3), []
    for _ in range(2):
        voltage = np.repeat(rng.uniform(-3, 3, 60), 20)
        speed = turned(voltage, lambda q, v: -LEVEL * np.tanh(v / width), substeps=fine)
        recorded.append({"voltage": voltage, "speed": speed + rng.normal(0, 2e-4, len(speed))})
    data = data_set({"voltage": "V", "speed": "rad/s"}, recorded, roles=["estimation", "validation"], sample_time=STEP)
    search = begun(data, motor)
    dry = attach(motor, "rotor", CoulombFriction())
    values = search.plain.values() | {f"{dry.prefix}.F_c": LEVEL, f"{dry.prefix}.v_0": width}
    return search.at(search.refitted((dry,), search.plain, [values]))


def test_a_sharp_law_is_fitted_to_whole_records_in_finer_steps(monkeypatch, data_set, motor, begun) -> None:
    """Seen: a winch's friction, 0.026 rad/s wide by 30 standard deviations, and 5 times the noise left; it was 0.02."""
    width = 0.02
    search = with_friction(data_set, motor, begun, width)
    found, settings = search.state.current, search.study.settings
    finer = in_steps_for_whole_records(found, settings)
    assert finer.simulator.substeps > found.simulator.substeps == 1
    assert [e.prefix for e in finer.effects] == [e.prefix for e in found.effects]
    assert finer.model.least_substeps == finer.simulator.substeps and finer.values() == found.values()
    final = finish(found, settings, search.study.budget)
    assert final.problem.model.least_substeps == finer.simulator.substeps
    (name,) = (n for n in final.values() if n.endswith("v_0"))
    assert final.values()[name] == pytest.approx(width, rel=0.05)
    monkeypatch.setattr(final_fits, "in_steps_for_whole_records", lambda hypothesis, settings: hypothesis)
    coarse = finish(found, settings, search.study.budget)
    assert coarse.problem.model is found.model
    assert abs(coarse.values()[name] - width) > 2 * abs(final.values()[name] - width)


def test_steps_that_change_little_stay_as_they_are(data_set, motor, begun) -> None:
    wide = with_friction(data_set, motor, begun, 0.5).state.current
    assert in_steps_for_whole_records(wide, DiagnosisSettings()) is wide


def test_the_model_as_it_stands_keeps_its_steps(motor_data, motor, begun) -> None:
    plain = begun(motor_data(), motor).plain
    assert in_steps_for_whole_records(plain, DiagnosisSettings()) is plain


def test_effects_that_the_model_came_with_are_the_models(data_set, motor, begun) -> None:
    found = with_friction(data_set, motor, begun, 0.02).state.current
    given = replace(found, effects=())
    assert in_steps_for_whole_records(given, DiagnosisSettings()) is given


def test_a_stored_effect_keeps_its_steps(data_set, motor, begun) -> None:
    search = with_friction(data_set, motor, begun, 0.02)
    finer = in_steps_for_whole_records(search.state.current, search.study.settings)
    again = restored_model(motor, stored_effects(finer.model))
    assert again.least_substeps == finer.model.least_substeps > 1
