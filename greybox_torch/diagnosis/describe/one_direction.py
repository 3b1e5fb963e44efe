"""Laws at one body that are the same force while it moves in one direction, where the recordings show no other."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import torch

from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.signals_along import local_signals
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.estimate.notes import with_value
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.travel import LITTLE, either_way
from greybox_torch.in_unit import in_unit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.model import Body

ALIKE = 0.95
"""Cosine of two forces along the motion from which they are hardly told apart."""

Law = Callable[[np.ndarray], np.ndarray]
"""A force over the speed."""


def with_likes(fitted: Hypothesis, effects: Sequence[Effect], final: Problem) -> tuple[Effect, ...]:
    """The effects (in the order of the hypothesis), each with the one that the other direction alone would tell from it.

    Args:
        final: with the values that the verdict gives.
    """
    model = fitted.model
    assert isinstance(model, AugmentedModel)
    bodies = {port.name for port in model.base.all_ports if isinstance(port, Body)}
    known = {}
    for attachment, effect in zip(fitted.effects, effects, strict=True):
        if attachment.port in bodies and _of_speed_alone(attachment, model):
            known[effect.prefix] = attachment
    speeds = {
        a.port: local_signals(model, a, fitted.fits[0], fitted.simulator)["speed"]
        for a in known.values()
        if [b.port for b in known.values()].count(a.port) > 1
    }
    laws = {prefix: _law(model, a, final) for prefix, a in known.items()}
    ways = {port: speed for port, speed in speeds.items() if not either_way(speed)}
    return tuple(replace(e, like=_told(e, effects, laws, ways)) for e in effects)


def _of_speed_alone(attachment: Attachment, model: AugmentedModel) -> bool:
    law = attachment.mechanism
    return set(law.needs) <= {"speed"} and not law.states(model.surroundings[attachment.port]) and not law.kinematic


def _law(model: AugmentedModel, attachment: Attachment, final: Problem) -> Law:
    def force(speed: np.ndarray) -> np.ndarray:
        found = model.curve(attachment, {"speed": torch.tensor(speed)}, final.parameter_tensors)
        return np.broadcast_to(np.asarray(found, dtype=float), speed.shape)

    return force


def _told(effect: Effect, effects: Sequence[Effect], laws: Mapping[str, Law], ways: Mapping[str, np.ndarray]) -> str:
    """With which others it is one force in the one direction, and what their sum is; "" for none."""
    if effect.port not in ways or effect.prefix not in laws:
        return ""
    speed = ways[effect.port]
    own = laws[effect.prefix]
    others = [
        other
        for other in effects
        if other.port == effect.port
        and other.prefix != effect.prefix
        and other.prefix in laws
        and alike_in_one_direction(own, laws[other.prefix], speed)
    ]
    if not others:
        return ""
    fast = np.quantile(speed, [0.01, 0.99])
    fast = fast[np.argmax(np.abs(fast))][None]
    total = abs(float(own(fast)[0] + sum(float(laws[o.prefix](fast)[0]) for o in others)))
    name = effect.signals[0] if effect.signals else "speed"
    unit, force = effect.profiles[0].unit if effect.profiles else "", _first(effect)[2]
    return (
        f"these recordings show one direction of motion, in which it cannot be told from {', '.join(map(_named, others))}: "
        f"of their forces the sum alone is known, {in_unit(f'{total:.4g}', force)} at {name} = {in_unit(f'{float(fast[0]):.3g}', unit)}. "
        "A recording in the other direction tells them apart"
    )


def alike_in_one_direction(one: Law, other: Law, speed: np.ndarray) -> bool:
    """Whether two laws are in proportion at the speeds (N,) of the recordings, rest aside, and not where the same are driven either way."""
    moving = speed[np.abs(speed) > LITTLE * np.abs(speed).max()]
    both = np.concatenate([moving, -moving])
    return _cosine(one(moving), other(moving)) > ALIKE > _cosine(one(both), other(both))


def _cosine(one: np.ndarray, other: np.ndarray) -> float:
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    return abs(float(one @ other)) / size if size > 0.0 else 0.0


def _named(effect: Effect) -> str:
    name, value, unit = _first(effect)
    return f"{spoken_at(effect.mechanism, effect.port)} ({with_value(name, value, unit)})"


def _first(effect: Effect) -> tuple[str, float, str]:
    name, entry = next(iter(effect.parameters.items()))
    return name, float(entry["value"]), str(entry.get("unit", ""))
