"""An effect in the words of a simulator of jointed bodies, and what could not be said."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from greybox_torch.mechanisms.attached import attached
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.copies import copy_holding
from greybox_torch.model.ports import Port

Attribute = tuple[float, ...] | str
ADDED = ("damping", "frictionloss", "stiffness", "biasprm", "relative_gain")
"""Attributes that several effects have a part in."""


@dataclass(frozen=True)
class Place:
    """Where an effect acts: the ``port`` of the model without effects, and the effect's ``values`` by short names."""

    model: GreyBoxModel
    port: Port
    values: Mapping[str, float]


@dataclass(frozen=True)
class Counterpart:
    """``attributes`` of the ``element`` ("joint", "tendon", "actuator", "constant") that is called ``name``."""

    element: str
    name: str
    attributes: Mapping[str, Attribute]


@dataclass(frozen=True)
class Unsaid:
    """Something of an ``effect`` (PORT.MECHANISM), and ``why`` it is not in the file."""

    effect: str
    why: str


Said = tuple[list[Counterpart], list[str]]
"""What an effect is, and what of it is not."""
Law = Callable[[Place], Said]


def counterparts(model: GreyBoxModel, laws: Mapping[str, Law], language: str) -> tuple[list[Counterpart], list[Unsaid]]:
    """All that ``laws``, by mechanism, have words for. Numbers for the same attribute of the same element are added up.

    Args:
        language: what the laws are in, for sentences.
    """
    base, attachments, _ = attached(model)
    base = copy_holding(base, {name: value for name, value in model.values().items() if name in base.values()})
    ports = {port.name: port for port in base.all_ports}
    found: list[Counterpart] = []
    unsaid: list[Unsaid] = []
    for a in attachments:
        law = laws.get(a.mechanism.name)
        if law is None:
            unsaid.append(Unsaid(a.prefix, _no_word(a, language)))
            continue
        place = Place(base, ports[a.port], a.own(model.values()))
        said, left = law(place)
        found += said
        unsaid += [Unsaid(a.prefix, why) for why in left]
    return _together(found), unsaid


def _no_word(a: Attachment, language: str) -> str:
    about = a.mechanism.explanation or "It is a learned curve."
    return f"{about} {language} has no element for it; the export as C or FMU has it"


def _together(found: Iterable[Counterpart]) -> list[Counterpart]:
    merged: dict[tuple[str, str], dict[str, Attribute]] = {}
    for one in found:
        own = merged.setdefault((one.element, one.name), {})
        for name, value in one.attributes.items():
            own[name] = _joined(name, own[name], value) if name in own else value
    return [Counterpart(element, name, attributes) for (element, name), attributes in merged.items()]


def _joined(name: str, first: Attribute, second: Attribute) -> Attribute:
    """Of coefficients the sum, of dead bands the one that holds both, of anything else the later."""
    if isinstance(first, str) or isinstance(second, str):
        return second
    if name == "springlength":
        return min(first[0], second[0]), max(first[1], second[1])
    if name not in ADDED:
        return second
    count = max(len(first), len(second))
    a, b = (values + (0.0,) * (count - len(values)) for values in (first, second))
    return tuple(x + y for x, y in zip(a, b, strict=True))
