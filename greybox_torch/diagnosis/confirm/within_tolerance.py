"""Effects that no model is exact to: told of a model that leaves little more than noise, they are not missing physics."""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.diagnosis.hypothesis.noise import output_floors
from greybox_torch.diagnosis.refit.curve import force_of
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.actuator import InputGain
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.lag import Lag
from greybox_torch.mechanisms.sensor import SensorGain
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body
from greybox_torch.model.own_friction import dry_friction
from greybox_torch.model.ports import Sensor

BY_SPEED_ALONE = (CoulombFriction.name, StribeckFriction.name)
"""Laws of dry friction without a memory, alike in both directions."""

GAINS = (InputGain.name, SensorGain.name)
"""Laws that are another gain than the recorded one."""


def within_tolerance(study: Study, state: SearchState, effect: Attachment, accounts_for: float) -> bool:
    """Whether an effect is a small shift in time, a small error of a gain, or friction where the model has its own.

    Args:
        accounts_for: its size, a share of the mismatch.
    """
    return (
        _within_a_sample(study, state, effect, accounts_for)
        or _within_calibration(study, state, effect)
        or _of_own_friction(study, state, effect)
    )


def _within_a_sample(study: Study, state: SearchState, effect: Attachment, accounts_for: float) -> bool:
    """Whether an effect is a shift in time by a small part of the interval between two recorded samples.

    When within it a sample was taken, and an input began to act, hardly anybody knows better than that. One that does not account for
    nearly all that is missing has to be larger: an input that does not change at once but over the interval is late by half of it. Seen: a
    complete reactor, told as a dead time of 0.3 samples (0.97), 72 % of what it left beyond the noise.
    """
    settings = study.settings
    least = settings.shortest_shift if accounts_for >= settings.nearly_all else settings.shift_of_a_hold
    return _later_by_less(study, state, effect, least)


def is_timing(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether an effect is a shift in time so small that it is none of the machine, however far above the noise of good sensors.

    Seen: a milling machine's axis, whose torque rises over a tenth of a millisecond, told with a lag of 26 µs (0.97) beside the play of its
    nut.
    """
    return _later_by_less(study, state, effect, study.settings.no_shift)


def within_noise_of_sensor(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether an effect is a curve of what a sensor shows wrongly, by hardly more than its noise.

    Many samples show that beyond chance, and nobody reads the sensor to less. Seen: the encoder of three pendulums, 2 mrad out over its
    turn where its step is 3 mrad, told as unknown at the sensor (0.97), validation 99.5 to 99.6 %.
    """
    curve, model = effect.mechanism, study.problem.model
    if not isinstance(curve, Unknown) or curve.signals() != ("output",):
        return False
    port = next(q for q in model.all_ports if q.name == effect.port)
    assert isinstance(port, Sensor)
    row = [o.name for o in model.outputs].index(port.output)
    measured = study.problem.records.y[row]
    shown = torch.as_tensor(measured[np.isfinite(measured)])
    wrong = force_of(state.current, effect, {"output": shown})
    noise = np.nanmean(output_floors(study.problem, study.settings)[:, row])
    return bool(np.sqrt(np.mean(wrong**2)) < study.settings.far_above_noise * np.sqrt(noise))


def _later_by_less(study: Study, state: SearchState, effect: Attachment, samples: float) -> bool:
    """Whether an effect is a lag or a delay of less than so many sampling intervals of what was recorded."""
    if effect.mechanism.nature != Lag.nature:
        return False
    recorded = study.problem.records if study.recorded is None else study.recorded
    return state.current.values()[f"{effect.prefix}.T"] < samples * float(np.median(recorded.dt))


def _within_calibration(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether an effect is an error of a gain that is smaller than sensors and drives are calibrated to.

    Seen: a complete furnace, told as a gain of a sensor that is 0.07 % off, and a complete pipeline, one of an input 0.16 %.
    """
    if effect.mechanism.name not in GAINS:
        return False
    return abs(state.current.values()[f"{effect.prefix}.gain_error"]) < study.settings.smallest_gain_error


def _of_own_friction(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether an effect is friction by speed alone of a body of which the model has dry friction already: it bends that law.

    Seen: a complete drum mixer, whose rollers stick where the model rounds their friction with a hyperbolic tangent, told as Coulomb
    friction (0.97).
    """
    model = study.problem.model
    body = next((q for q in model.ports if q.name == effect.port), None)
    if effect.mechanism.name not in BY_SPEED_ALONE or not isinstance(body, Body):
        return False
    fastest = study.surroundings[effect.port].ranges["speed"].reach
    level = state.current.values()[f"{effect.prefix}.F_c"]
    return dry_friction(model, body, fastest, state.plain.values()) > study.settings.own_friction * level
