"""One effect that a diagnosis found: its parts, and its entry in `verdict.json` (contract, sections 4 and 8)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from greybox_torch.by_name import ByName
from greybox_torch.diagnosis.curve import Curve
from greybox_torch.diagnosis.determined import listed_with_values, told_undetermined
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.memory import Memory
from greybox_torch.diagnosis.one_of import Alternative, OneOf, spoken_at
from greybox_torch.estimate.notes import told_law_at_bound
from greybox_torch.mechanisms.pitch import pitch_of

SO_LITTLE = "so little that it may only compensate for the inexact form of the other laws"
"""Why most refinements are no findings."""


@dataclass(frozen=True)
class Profile:
    """Where an effect's gain lies along one signal: bin edges (n + 1,) in the signal's unit, share of the explained energy per bin (n,).

    ``seen``: the share of the samples per bin (n,), where known; ``levels``: the values of a signal that has only a few, as an input of
    steps.
    """

    signal: str
    unit: str
    edges: np.ndarray
    share: np.ndarray
    seen: np.ndarray | None = None
    levels: tuple[float, ...] = ()


@dataclass(frozen=True)
class Timeline:
    """Where an effect's gain lies along one experiment: window edges (n + 1,) in s, each window's share of all experiments' gain (n,)."""

    experiment: str
    edges: np.ndarray
    share: np.ndarray

    @property
    def intensity(self) -> float:
        """Share per second."""
        return float(self.share.sum() / (self.edges[-1] - self.edges[0]))


@dataclass(frozen=True)
class Effect:
    """One finding. ``explained`` is the share of the repeatable validation error that it removes.

    ``ceiling`` is the share of the best free curve's gain that a named effect reaches; None where no curve was fitted beside it.
    """

    port: str
    mechanism: str
    probability: float
    signals: tuple[str, ...]
    where: str
    parameters: Mapping[str, Mapping[str, Any]]
    explained: float
    alternatives: tuple[Alternative, ...]
    curve: Curve | None
    profiles: tuple[Profile, ...] = ()
    explanation: str = ""
    source: str = ""
    separating_experiment: str = ""
    ceiling: float | None = None
    timelines: tuple[Timeline, ...] = ()
    size: float = float("nan")
    """Share of the mean squared held-out mismatch of the refitted plain model that leaving the effect out brings back."""

    memory: Memory | None = None
    """The response of an unknown effect that depends on the past; its ``curve`` is what the force settles at."""

    one_of: OneOf | None = None
    """What these recordings cannot tell from it, as one statement; None where it stands alone."""

    law: str = ""
    """The name that its parameters have in the recommended model, where that is not ``mechanism``: an unknown effect has several forms."""

    form: str = ""
    """Of an unknown effect that is no curve over one signal: what it is instead, as a noun."""

    equation: str = ""
    """What it adds at its port, as one would write it into the model's class, or in words where that is no formula; "" for a bent curve."""

    made_up_for: str = ""
    """Where the recordings do not show it, as the re-estimated model makes up for it: how that is known, in words."""

    at_bounds: tuple[str, ...] = ()
    """Which of its parameters ended at one of their bounds."""

    of_units: str = ""
    """That a gain is the factor of a unit that the model's equations may lack, or why there are none, a clause; "" elsewhere."""

    like: str = ""
    """Which other effects are the same force in the one direction of motion that the recordings show, a clause; "" for none."""

    amplitudes: Mapping[str, tuple[float, float | None]] = field(default_factory=dict)
    """Of a law of waves their size, whatever the phase, and its deviation, by the parameter behind which it is told."""

    of_line: str = ""
    """How well a straight line, which is its ``equation``, does in the place of its curve, a clause; "" where none was put there."""

    shared: str = ""
    """Which parameters of the model do what its curve can do as well, a clause; "" for none."""

    of_sign: str = ""
    """That a term of the model's equations may have the wrong sign, a clause that asks; "" elsewhere."""

    limited: tuple[str, ...] = ()
    """Why no more is claimed for it, where what was compared with it leaves it more; clauses."""

    why_small: str = SO_LITTLE
    """Of a refinement: why it is no finding, a clause."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", ByName(self.parameters))  # which says what names there are

    def __repr__(self) -> str:
        return f"<effect: {self.mechanism} at {self.port}, probability {self.probability:.2f}>"

    def no_surer_than(self, highest: float, class_at_most: float = 1.0) -> Effect:
        """The same with that probability at most, as a member of its class too, and the class with its own."""
        probability, whole = min(self.probability, highest), self.one_of
        if whole is not None:
            members = (replace(m, probability=min(m.probability, highest)) for m in whole.members)
            whole = replace(whole, members=tuple(members), probability=min(whole.probability, class_at_most))
        return replace(self, probability=probability, one_of=whole)

    @property
    def prefix(self) -> str:
        """What the names of its parameters begin with."""
        return f"{self.port}.{self.law or self.mechanism}"

    @property
    def shown_parameters(self) -> Mapping[str, Mapping[str, Any]]:
        """Those that mean something one by one: all but the heights of a curve."""
        if self.mechanism != "unknown":
            return self.parameters
        if self.memory is None:
            return {n: v for n, v in self.parameters.items() if not n.startswith(("w_", "first", "spacing"))}
        return {n: v for n, v in self.parameters.items() if not self.memory.curved or n == "T"}

    def pitch(self, name: str) -> tuple[float, float | None, str] | None:
        """In which travel its law repeats, with its deviation and unit, if the parameter ``name`` is an order over one."""
        told = self.parameters[name]
        if name != "order" or told.get("value") is None:
            return None
        return pitch_of(float(told["value"]), told.get("unit", ""), told.get("std"))

    @property
    def undetermined(self) -> str:
        """Which parameters of a law have a standard deviation above their value, or why none has one, in a sentence; "" elsewhere."""
        return "" if self.mechanism == "unknown" else told_undetermined(self.shown_parameters, self.at_bounds)

    @property
    def bounded(self) -> str:
        """Which parameters of a law are at a bound; "" elsewhere."""
        return told_law_at_bound(self._at_bounds) if self._at_bounds else ""

    @property
    def _at_bounds(self) -> str:
        return "" if self.mechanism == "unknown" else listed_with_values(self.shown_parameters, self.at_bounds)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader of the evidence has to know of its parameters and its probability; in clauses, but for what a bound means."""
        bounded = f"at a bound: {self._at_bounds}" if self._at_bounds else ""
        return tuple(
            filter(None, (self.of_units, self.of_line, self.shared, self.like, self.of_sign, bounded, *self.limited))
        )

    @property
    def headline(self) -> str:
        """The finding as a headline has it: the statement of what cannot be told apart, or the law and its place."""
        if self.one_of is None:
            form = f", {self.form}" if self.form else ""
            form = form if self.memory is None else f", {self.memory.told}"
            return f"{spoken_at(self.mechanism, self.port)}{form} (probability {self.probability:.2f})"
        return f"{self.one_of.statement} (probability {self.one_of.probability:.2f}, {self.one_of.likeliest})"

    @property
    def sentence(self) -> str:
        """What a reader has to know of it where it is no finding."""
        said, size = spoken_at(self.mechanism, self.port), digits(100 * self.size)
        values = "" if self.mechanism == "unknown" else listed_with_values(self.shown_parameters, list(self.parameters))
        said += f" ({values})" if values else ""
        return f"{said} accounts for {size} % of the whole mismatch: {self.why_small}"

    def as_json(self) -> dict[str, Any]:
        """Its entry under `effects`."""
        result: dict[str, Any] = {
            "port": self.port,
            "mechanism": self.mechanism,
            "probability": self.probability,
            "size": self.size,
            "signals": list(self.signals),
            "where": self.where,
            "parameters": {n: dict(v) for n, v in self.parameters.items()},
            "explained": self.explained,
            "alternatives": [a.as_json() for a in self.alternatives],
        }
        if self.equation:
            result["equation"] = self.equation
        if self.of_line:
            result["of_equation"] = self.of_line
        if self.shared:
            result["shared"] = self.shared
        if self.amplitudes:
            result["amplitudes"] = [self._amplitude(*told) for told in self.amplitudes.items()]
        if self.one_of is not None:
            result["one_of"] = self.one_of.as_json()
        if self.ceiling is not None:
            result["ceiling"] = self.ceiling
        if self.curve is not None and self.mechanism == "unknown":
            result["curve"] = self.curve.as_json()
        if self.memory is not None:
            result["memory"] = self.memory.as_json()
        return result

    def _amplitude(self, sine: str, size: tuple[float, float | None]) -> dict[str, Any]:
        """The entry of a wave whose sine's amplitude has that name."""
        both = [sine.replace("b", "a", 1), sine]
        return {"of": both, "value": size[0], "std": size[1], "unit": self.parameters[sine].get("unit", "")}

    def as_refinement_json(self) -> dict[str, Any]:
        """Its entry under `refinements`, where it is too small for a finding."""
        return {
            "port": self.port,
            "mechanism": self.mechanism,
            "size": self.size,
            "probability": self.probability,
            "sentence": f"{self.sentence}.",
            "parameters": {n: dict(v) for n, v in self.parameters.items()},
        }
