"""Whether a mechanism is complete, tried out on made-up signals, before it is offered to every diagnosis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Range, Surroundings
from greybox_torch.model import Parameter, Signals
from greybox_torch.model.signals import parameter_signals

SIGNALS: dict[str, tuple[str, ...]] = {
    "body": ("speed", "position", "load", "time", "sample_time"),
    "coupling": ("deflection", "rate", "position", "load", "speed", "time"),
    "balance": ("level", "time"),
    "actuator": ("input", "delayed", "speed", "position", "time", "sample_time"),
    "sensor": ("output", "time", "sample_time"),
}
"""The signals at a port, by kind of port."""

_UNITS = {
    "speed": "rad/s",
    "position": "rad",
    "load": "N m",
    "deflection": "rad",
    "rate": "rad/s",
    "level": "m",
    "time": "s",
}
_POINTS = 7


def check_mechanism(law: Any) -> None:
    """Raises UserError that says which attribute or method of the class ``law`` is missing or wrong, and what is expected."""
    if not (isinstance(law, type) and issubclass(law, Mechanism)):
        raise UserError(f"register: got {law!r}; expected a subclass of greybox_torch.Mechanism")
    _check_attributes(law)
    try:
        mechanism = law()
    except Exception as error:
        raise _wrong(law, f"cannot be made without arguments ({_said(error)}); give every argument a default") from None
    around = _made_up(law)
    parameters = _tried(law, "parameters(around)", lambda: list(mechanism.parameters(around)))
    _check_parameters(law, parameters)
    bounds = {p.name: p.bounds for p in parameters}
    _check_probes(law, _tried(law, "probes(around)", lambda: list(mechanism.probes(around))), bounds)
    _check_law(law, mechanism, around, parameters)


def _check_attributes(law: type[Mechanism]) -> None:
    name, kinds = getattr(law, "name", None), getattr(law, "kinds", None)
    if not (isinstance(name, str) and name.isidentifier() and name == name.lower()):
        raise _wrong(law, f"attribute 'name' is {name!r}; expected lower-case words joined by _, such as \"magnet\"")
    if not (isinstance(kinds, tuple) and kinds and set(kinds) <= set(SIGNALS)):
        raise _wrong(
            law, f"attribute 'kinds' is {kinds!r}; expected a tuple of kinds of port, out of {', '.join(SIGNALS)}"
        )
    if not (isinstance(law.needs, tuple) and all(isinstance(n, str) for n in law.needs)):
        raise _wrong(law, f"attribute 'needs' is {law.needs!r}; expected a tuple of signals, such as (\"speed\",)")
    for kind in kinds:
        if unknown := [n for n in law.needs if n not in SIGNALS[kind]]:
            raise _wrong(
                law,
                f"attribute 'needs' has {unknown[0]!r}, which a {kind} does not have; expected out of {', '.join(SIGNALS[kind])}",
            )
    if not (isinstance(law.explanation, str) and law.explanation.strip()):
        raise _wrong(law, "attribute 'explanation' is empty; expected one sentence for the report")


def _check_parameters(law: type[Mechanism], parameters: list[Any]) -> None:
    if not parameters or not all(isinstance(p, Parameter) for p in parameters):
        raise _wrong(law, f"parameters(around) gives {parameters!r}; expected a list of Parameter, at least one")
    names = [p.name for p in parameters]
    if twice := {n for n in names if names.count(n) > 1}:
        raise _wrong(law, f"parameters(around) names {', '.join(sorted(twice))} twice")
    if SHARE in names:
        raise _wrong(
            law, f"parameters(around) names a parameter '{SHARE}', which stands for the whole effect; call it otherwise"
        )


def _check_probes(law: type[Mechanism], probes: list[Any], bounds: Mapping[str, tuple[float, float]]) -> None:
    if not probes:
        raise _wrong(
            law, "probes(around) gives none; expected one Probe or more, or no diagnosis would ever look for it"
        )
    for probe in probes:
        for name in (*probe.directions, *probe.values):
            if name != SHARE and name not in bounds:
                raise _wrong(
                    law, f"probes(around) has '{name}', which is no parameter; expected one of {', '.join(bounds)}"
                )
        for name in set(probe.directions) - {SHARE}:
            low, high = bounds[name]
            if not low <= 0.0 <= high:
                raise _wrong(
                    law, f"probes(around) looks along '{name}' from zero, which its bounds [{low:g}, {high:g}] exclude"
                )


def _check_law(law: type[Mechanism], mechanism: Mechanism, around: Surroundings, parameters: list[Parameter]) -> None:
    """The law is elementwise mathematics, its memory has rates, and where its amplitudes are zero it is absent."""
    directions = {name for probe in mechanism.probes(around) for name in probe.directions}
    zero = {p.name: 0.0 if p.name in directions and SHARE not in directions else p.value for p in parameters}
    present = {p.name: min(0.5, p.bounds[1]) if p.name in directions else p.value for p in parameters}
    change = _change(law, mechanism, around, present, _POINTS)
    fewer = _change(law, mechanism, around, present, _POINTS - 3)
    if change is None or fewer is None or not torch.equal(change[: _POINTS - 3], fewer):
        raise _wrong(
            law, "its law is not elementwise mathematics: expected one value a point, which depends on that point alone"
        )
    absent = _change(law, mechanism, around, zero, _POINTS)
    if SHARE not in directions and absent is not None and bool((absent != 0.0).any()):
        raise _wrong(
            law, f"its law is not absent where {', '.join(sorted(directions))} are zero, as probes(around) says it is"
        )


def _change(
    law: type[Mechanism], mechanism: Mechanism, around: Surroundings, values: Mapping[str, float], points: int
) -> torch.Tensor | None:
    """What the law adds at ``points`` made-up points (the same ones every time), None where that is not one value a point."""
    drawn = torch.rand(
        (len(SIGNALS[law.kinds[0]]), _POINTS), generator=torch.Generator().manual_seed(0), dtype=torch.float64
    )
    s = Signals("signal", {n: row[:points] + 0.1 for n, row in zip(SIGNALS[law.kinds[0]], drawn, strict=True)})
    p = parameter_signals(values)
    z = Signals("memory", {m.name: torch.zeros(points, dtype=torch.float64) for m in mechanism.states(around)})
    rates = _tried(law, "rates(s, p, z)", lambda: mechanism.rates(s, p, z))
    if set(rates) != set(z):
        raise _wrong(law, f"rates(s, p, z) has {sorted(rates)}; expected one for every state, {sorted(z)}")
    if mechanism.kinematic:
        change = _tried(law, "deflection(s, p)", lambda: mechanism.deflection(s, p)) - s.deflection
    else:
        change = _tried(law, "force(s, p, z)", lambda: mechanism.force(s, p, z))
    try:
        return torch.as_tensor(change, dtype=torch.float64).expand(points)
    except RuntimeError:
        return None


def _made_up(law: type[Mechanism]) -> Surroundings:
    ranges = {name: Range(-1.0, 2.0, 0.9) for kind in law.kinds for name in SIGNALS[kind]} | {
        "time": Range(0.0, 10.0, 6.0)
    }
    return Surroundings(ranges, _UNITS, "N m", 1e-3)


def _tried(law: type[Mechanism], what: str, call: Any) -> Any:
    try:
        return call()
    except NotImplementedError:
        raise _wrong(law, f"does not define {what}") from None
    except UserError as error:
        raise _wrong(law, f"{what}: {error}") from None
    except Exception as error:
        raise _wrong(law, f"{what} raised {_said(error)}") from None


def _said(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def _wrong(law: type, what: str) -> UserError:
    return UserError(f"register: mechanism {law.__name__}: {what}")
