"""The response of an unknown that remembers, and the curve that is left of it once all has settled."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import torch

from greybox_torch.diagnosis.describe.hysteresis import hysteresis_loop
from greybox_torch.diagnosis.describe.profiles import POINTS
from greybox_torch.diagnosis.effect import Curve
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.memory import Memory
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.input_follower import InputFollower
from greybox_torch.mechanisms.matching import law_force
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.transmission import HystereticSpring
from greybox_torch.mechanisms.unknown_fading import UnknownFading
from greybox_torch.mechanisms.unknown_map import UnknownMap
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory

FREQUENCIES = 81
"""At which the response is given, evenly on a logarithmic scale."""

DECADES = 2.0
"""On either side of the corner frequency, as far as record and sampling reach."""

STEP = 1e-4
"""By which a parameter is changed for a derivative, as a share of its value."""


def remembered(attachment: Attachment, around: Surroundings, final: Final, signal: str) -> Memory | None:
    """The response of an effect with its band, from the fit to whole records; None for an effect that is no free response.

    Args:
        signal: the model's own name of what it is a response to.
    """
    mechanism = attachment.mechanism
    if not isinstance(mechanism, UnknownWithMemory):
        return None
    values, covariances = _own(attachment, final)
    corner = 1.0 / (2 * np.pi * mechanism.seconds(values))
    slowest = 1.0 / around.ranges["time"].span if "time" in around.ranges else corner
    fastest = 0.5 / around.sample_time
    low = min(max(corner * 10.0**-DECADES, slowest), corner)
    frequency = np.geomspace(low, max(min(corner * 10.0**DECADES, fastest), 2 * corner), FREQUENCIES)

    def response(at: Mapping[str, float]) -> np.ndarray:
        return mechanism.response(at, 2 * np.pi * frequency)

    gain = response(values)
    size = np.maximum(np.abs(gain), 1e-300)
    relative = _derivatives(response, values, list(covariances[0])) / (gain / size)[:, None]
    spread, turned = (_deviation(part, covariances[1]) for part in (relative.real, relative.imag / size[:, None]))
    lasting = _derivatives(lambda at: np.array([mechanism.seconds(at)]), values, list(covariances[0]))
    deviation = float(_deviation(lasting, covariances[1])[0]) if covariances[0] else np.nan
    return Memory(
        signal,
        around.per(mechanism.signal) if mechanism.in_front is None else "",
        mechanism.in_front is not None,
        mechanism.modes,
        mechanism.seconds(values),
        deviation if np.isfinite(deviation) else None,
        frequency,
        gain,
        spread,
        turned,
    )


def settled_curve(attachment: Attachment, around: Surroundings, final: Final) -> Curve | None:
    """The force over the signal once all has settled, as the entry `curve` of a free response or of a gain that fades.

    Of play and of a hysteretic spring the loop, of a limit of the rate what that lacks over the rate of the input. None for others.
    """
    mechanism = attachment.mechanism
    if isinstance(mechanism, HystereticSpring):
        return hysteresis_loop(mechanism, around, _own(attachment, final)[0])
    if isinstance(mechanism, InputFollower):
        return Curve(*mechanism.drawn(around, _own(attachment, final)[0], POINTS))
    if isinstance(mechanism, UnknownMap):
        return _of_map(mechanism, around, _own(attachment, final)[0])
    if not isinstance(mechanism, UnknownWithMemory | UnknownFading):
        return None
    values, _ = _own(attachment, final)
    span = around.ranges[mechanism.signal]
    grid = np.linspace(span.low, span.high, POINTS)
    if isinstance(mechanism, UnknownFading):
        force = mechanism.settled(grid, values)
    elif mechanism.in_front is None:
        force = float(mechanism.response(values, np.zeros(1))[0].real) * grid
    else:
        force = law_force(mechanism.in_front, around, {mechanism.signal: torch.as_tensor(grid)}, values)
    return Curve(mechanism.signal, around.units.get(mechanism.signal, ""), grid, force, around.force_unit)


def _of_map(mechanism: UnknownMap, around: Surroundings, values: Mapping[str, float]) -> Curve:
    """The map over its first signal, where the second one is in the middle of its range."""
    first, second = (around.ranges[signal] for signal in mechanism.needs)
    grid = np.linspace(first.low, first.high, POINTS)
    middle = np.full(POINTS, 0.5 * (second.low + second.high))
    there = {name: torch.as_tensor(v) for name, v in zip(mechanism.needs, (grid, middle), strict=True)}
    force = law_force(mechanism, around, there, values)
    return Curve("input", around.units.get("input", ""), grid, force, around.force_unit)


def _own(
    attachment: Attachment, final: Final
) -> tuple[dict[str, float], tuple[tuple[str, ...], tuple[np.ndarray, ...]]]:
    """The effect's parameters by their short names; those with a covariance, and the covariances (k, k), plain and sandwich."""
    start = f"{attachment.prefix}."
    final = final.told
    known = final.deviations()
    at = [k for k, n in enumerate(known) if n.startswith(start) and np.isfinite(known[n])]
    names = tuple(list(known)[k].removeprefix(start) for k in at)
    found = final.uncertainty
    both = () if found is None else tuple(c[np.ix_(at, at)] for c in (found.plain, found.sandwich))
    return attachment.own(final.values()), (names, both)


def _derivatives(
    of: Callable[[Mapping[str, float]], np.ndarray], values: Mapping[str, float], names: list[str]
) -> np.ndarray:
    """Derivatives (F, k) by the parameters ``names``, by central differences."""
    columns = []
    for name in names:
        step = STEP * max(abs(values[name]), 1e-300)
        ahead, behind = ({**values, name: values[name] + sign * step} for sign in (1.0, -1.0))
        columns.append((of(ahead) - of(behind)) / (2 * step))
    return np.stack(columns, axis=1) if columns else np.zeros((len(of(values)), 0))


def _deviation(derivatives: np.ndarray, covariances: tuple[np.ndarray, ...]) -> np.ndarray:
    """Standard deviation (F,) of what has these real derivatives (F, k): the larger of those by the covariances; NaN without any."""
    found = [np.einsum("fi,ij,fj->f", derivatives, c, derivatives) for c in covariances if derivatives.shape[1]]
    return np.sqrt(np.maximum(np.max(found, axis=0), 0.0)) if found else np.full(len(derivatives), np.nan)
