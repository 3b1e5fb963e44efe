"""A picture of a law: its force over a signal that swings, the memory of the law along."""

from __future__ import annotations

import io
from collections.abc import Mapping

import matplotlib
import numpy as np
import torch
from matplotlib.figure import Figure

from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Range, Surroundings
from greybox_torch.model import Signals

STEPS_A_TURN = 400
TURNS = 3

_PHASE = np.linspace(0.0, 2 * np.pi * TURNS, TURNS * STEPS_A_TURN + 1)
_STEP = float(_PHASE[1])
SAMPLE_TIME = 0.3
"""That the laws are told, so that lags and delays, which are some samples long, can be seen."""

SWING = {
    "time": _PHASE,
    "speed": np.cos(_PHASE),
    "position": np.sin(_PHASE),
    "load": 0.6 + 0.4 * np.sin(_PHASE),
    "deflection": np.sin(_PHASE),
    "rate": np.cos(_PHASE),
    "level": 1.0 + 0.8 * np.sin(_PHASE),
    "input": np.sin(_PHASE),
    "delayed": np.sin(_PHASE - SAMPLE_TIME),
    "output": np.sin(_PHASE),
    "sample_time": np.full_like(_PHASE, SAMPLE_TIME),
}
"""Signals at a port, of size one, one turn in 2π seconds."""

AROUND = Surroundings(
    {name: Range(float(values.min()), float(values.max()), float(values.std())) for name, values in SWING.items()},
    {},
    "",
    SAMPLE_TIME,
)


CHANGED = {"actuator": "input", "sensor": "output"}
"""Ports whose laws change a signal instead of adding a force."""


def force_over_signal(mechanism: Mechanism) -> tuple[str, np.ndarray, np.ndarray]:
    """The name of the signal, its values over the last turn, and what the law makes of it.

    That is the force; of a kinematic law, of an actuator's and of a sensor's it is the changed signal. What changes with time is over time.
    """
    values = _some_values(mechanism)
    p = Signals("parameter", {name: torch.tensor(value, dtype=torch.float64) for name, value in values.items()})
    states = [state.name for state in mechanism.states(AROUND)]
    signals = Signals("signal", {name: torch.as_tensor(swing) for name, swing in SWING.items()})
    memory = _memory_along(mechanism, p, states) if states else Signals("memory", {})
    kind = mechanism.kinds[0]
    changed = SWING[CHANGED[kind]] if kind in CHANGED else 0.0
    force = mechanism.deflection(signals, p) if mechanism.kinematic else mechanism.force(signals, p, memory)
    made = np.broadcast_to(np.asarray(force, dtype=float), _PHASE.shape) + changed
    if "time" in mechanism.needs:
        return "time", _PHASE, made
    name = CHANGED.get(kind) or next(iter(mechanism.signals()), "position")
    last = slice(-STEPS_A_TURN - 1, None)
    return name, SWING[name][last], made[last]


def _some_values(mechanism: Mechanism) -> dict[str, float]:
    """Parameters of a law that can be seen: amplitudes of one, shapes as the screen looks at them."""
    probe = mechanism.probes(AROUND)[0]
    values = {parameter.name: float(parameter.value) for parameter in mechanism.parameters(AROUND)} | dict(probe.values)
    for parameter in mechanism.parameters(AROUND):
        if parameter.name in probe.directions and parameter.name != SHARE:
            values[parameter.name] = 1.0 if parameter.upper is None else min(1.0, 0.5 * parameter.upper)
    return values


def _memory_along(mechanism: Mechanism, p: Signals, states: list[str]) -> Signals:
    """The memory at every sample, by Euler steps from rest, five of them between samples."""
    held: dict[str, list[torch.Tensor]] = {name: [] for name in states}
    now: Mapping[str, torch.Tensor] = {name: torch.zeros((), dtype=torch.float64) for name in states}
    fine = 5
    for k in range(len(_PHASE)):
        here = Signals("signal", {n: torch.tensor(swing[k], dtype=torch.float64) for n, swing in SWING.items()})
        for name in states:
            held[name].append(now[name])
        for _ in range(fine):
            rates = mechanism.rates(here, p, Signals("memory", dict(now)))
            now = {name: now[name] + _STEP / fine * rates[name] for name in states}
    return Signals("memory", {name: torch.stack(values) for name, values in held.items()})


def picture(mechanism: Mechanism) -> bytes:
    """The law as an SVG, the same bytes for the same law."""
    name, over, force = force_over_signal(mechanism)
    figure = Figure(figsize=(2.6, 1.7), layout="constrained")
    axes = figure.add_subplot()
    axes.axhline(0.0, color="#8a8a8a", linewidth=0.6)
    if mechanism.kinds[0] in CHANGED or mechanism.kinematic:
        axes.plot(over, over, color="#8a8a8a", linewidth=1.0, linestyle="--")
    axes.plot(over, force, color="#0b6e99", linewidth=1.6)
    axes.set_xlabel(name)
    axes.set_xticks([])
    axes.set_yticks([])
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    file = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": mechanism.name}):
        figure.savefig(file, format="svg", metadata={"Date": None}, facecolor="white")
    return file.getvalue()
