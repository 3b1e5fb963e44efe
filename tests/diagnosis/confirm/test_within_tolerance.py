"""What is told of a model that leaves little more than noise, and is no missing physics: small errors of gains, and friction of its own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import within_tolerance as module
from greybox_torch.diagnosis.confirm.standing import BY_TIMING, refinements, why_refinements
from greybox_torch.diagnosis.confirm.within_tolerance import is_timing, within_noise_of_sensor, within_tolerance
from greybox_torch.diagnosis.effect import SO_LITTLE
from greybox_torch.diagnosis.hypothesis.fit import hypothesis
from greybox_torch.mechanisms.actuator import InputDelay, InputGain, InputLag
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.sensor import SensorGain, SensorLag
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.unknown import Unknown


@pytest.fixture
def state(stub) -> Any:
    return lambda **values: stub(current=stub(values=lambda: values), plain=stub(values=dict))


@pytest.mark.parametrize(("port", "law"), [("actuator", InputGain()), ("sensor", SensorGain())])
@pytest.mark.parametrize(("error", "within"), [(0.0007, True), (-0.0016, True), (0.0041, False), (-0.2, False)])
def test_an_error_of_a_gain_is_larger_than_calibrations_are(dead_zone_search, state, port, law, error, within) -> None:
    effect = Attachment(port, law)
    found = state(**{f"{effect.prefix}.gain_error": error})
    assert within_tolerance(dead_zone_search.study, found, effect, 1.0) is within


@pytest.mark.parametrize(
    ("law", "within"),
    [
        (CoulombFriction(), True),
        (StribeckFriction(), True),
        (PreslidingHysteresis(), False),  # a memory that the model's own law has not
        (ConstantBias(), False),
    ],
)
def test_friction_by_speed_of_a_body_that_has_it_bends_what_is_there(
    dead_zone_search, stub, monkeypatch, law: Mechanism, within: bool
) -> None:
    """Seen: a complete drum mixer, told as Coulomb friction (0.97): its rollers stick, where the model rounds."""
    effect = Attachment("rotor", law)
    found = stub(current=stub(values=lambda: {f"{effect.prefix}.F_c": 1.0}), plain=stub(values=dict))
    for own, enough in ((0.0, False), (0.2, False), (0.5, True)):
        monkeypatch.setattr(module, "dry_friction", lambda model, body, fastest, values, own=own: own)
        assert within_tolerance(dead_zone_search.study, found, effect, 1.0) is (within and enough)


@pytest.mark.parametrize("law", [InputDelay(), InputLag(), SensorLag(True)])
@pytest.mark.parametrize(
    ("samples", "size", "times", "told"),
    [
        (0.22, 0.95, 1.7, False),
        (0.30, 0.95, 1.7, True),
        (0.30, 0.72, 1.7, False),
        (0.59, 0.72, 1.7, True),
        (0.17, 0.72, 390.0, True),
    ],
)
def test_a_shift_within_a_sampling_interval_is_no_finding_near_the_noise(
    dead_zone_search, stub, law, samples, size, times, told
) -> None:
    """Seen: a drone that nothing is missing from, told as a dead time of a tenth of a sample (0.97). As recorded, not as it is searched.

    And a lag of a sixth of a sample that stood 390 times above the noise, as which it is a finding.
    """
    effect = Attachment("actuator" if law.name.startswith("input") else "sensor", law)
    study = dead_zone_search.study
    for factor in (1.0, 5.0):
        records = replace(study.problem.records, dt=study.problem.records.dt / factor)
        recorded = None if factor == 1.0 else records
        seconds = samples * float(records.dt[0])
        current = stub(values=lambda seconds=seconds: {f"{effect.prefix}.T": seconds}, problem=study.problem)
        plain = stub(fits=[replace(f, mean_square=4e-4 * times**2) for f in dead_zone_search.plain.fits])
        state = stub(effects=(effect,), prefixes={effect.prefix}, current=current, plain=plain)
        others = stub(times_noise=lambda hypothesis: np.array([1.0]))
        asked = replace(study, recorded=recorded)
        assert (not refinements(asked, state, others, {}, {effect.prefix: size})) is told


@pytest.mark.parametrize(("samples", "timing"), [(0.026, True), (0.16, False)])
def test_a_shift_by_next_to_nothing_of_a_sampling_interval_is_never_a_finding(
    dead_zone_search, state, samples: float, timing: bool
) -> None:
    """Seen: an axis of a milling machine whose torque rises over a tenth of a millisecond, told with a lag beside the play of its nut."""
    study = dead_zone_search.study
    effect, interval = Attachment("actuator", InputLag()), float(np.median(study.problem.records.dt))
    found = state(**{f"{effect.prefix}.T": samples * interval})
    assert is_timing(study, found, effect) is timing
    assert not is_timing(study, found, Attachment("rotor", ConstantBias())), "no shift in time"


@pytest.mark.parametrize(("size", "why"), [(0.64, BY_TIMING), (0.001, SO_LITTLE)])
def test_why_a_shift_in_time_is_a_refinement(dead_zone_search, stub, size: float, why: str) -> None:
    """Seen: a lag that accounts for 64 % of the whole mismatch, "so little that it may only compensate"."""
    study, effect = dead_zone_search.study, Attachment("actuator", InputLag())
    seconds = 0.02 * float(np.median(study.problem.records.dt))
    current = stub(values=lambda: {f"{effect.prefix}.T": seconds}, problem=study.problem)
    state = stub(effects=(effect,), prefixes={effect.prefix}, current=current, plain=dead_zone_search.plain)
    others = stub(times_noise=lambda hypothesis: np.array([10.0]))
    assert why_refinements(study, state, others, {}, {effect.prefix: size}) == {effect.prefix: why}


@pytest.mark.parametrize(("times", "within"), [(1.0, True), (10.0, False)])
def test_what_a_sensor_shows_wrongly_by_hardly_more_than_its_noise(motor_data, motor, begun, times, within) -> None:
    """Seen: a pendulum's encoder, 2 mrad out where its step is 3 mrad, told as unknown at the sensor (0.97)."""
    noise = 0.02
    search = begun(motor_data(noise=noise), motor)
    for port, signal, own in (("sensor", "output", within), ("rotor", "speed", False)):
        curve = attach(motor, port, Unknown(signal, 8))
        heights = {f"{curve.prefix}.w_{k}": 0.5 * times * noise for k in range(8)}
        start = search.plain.values() | heights
        asked: dict[str, Any] = {"options": search.study.options, "frozen": frozenset(heights)}
        drawn = hypothesis(search.problem, (curve,), search.surroundings, [start], **asked)
        assert drawn is not None
        assert within_noise_of_sensor(search.study, search.at(drawn).state, curve) is own
