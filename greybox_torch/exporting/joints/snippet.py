"""A snippet for a simulator of jointed bodies: its text, and what could not be said in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Comment, Element, indent, tostring

from greybox_torch.exporting.joints.counterpart import Attribute, Counterpart, Unsaid
from greybox_torch.in_unit import in_unit
from greybox_torch.model import GreyBoxModel


@dataclass(frozen=True)
class Snippet:
    """``text`` of the file called ``name``; ``said`` counts the elements in it."""

    name: str
    text: str
    said: tuple[Counterpart, ...]
    unsaid: tuple[Unsaid, ...]


def written(root: Element, how: Sequence[str], unsaid: Sequence[Unsaid]) -> str:
    """The document with comments at its head: how it is used, and what is not in it."""
    remarks = [*how, *(f"{one.effect}: {one.why}" for one in unsaid)]
    for place, remark in enumerate(remarks):
        root.insert(place, Comment(f" {_plain(remark)} "))
    indent(root)
    return tostring(root, encoding="unicode") + "\n"


def shown(value: Attribute) -> str:
    return value if isinstance(value, str) else " ".join(f"{number:.10g}" for number in value)


def own_values(model: GreyBoxModel) -> str:
    """A sentence with the model's own parameters: masses, inertias and springs are the simulation's.

    They were found with the effects, so that it does not call them those of the model without effects, which `compare` scores.
    """
    values, units = model.values(), {p.name: p.unit for p in model.plain.declared_parameters}
    told = ", ".join(in_unit(f"{name} = {values[name]:.6g}", unit) for name, unit in units.items())
    return f"Beside these effects, the model's own parameters are {told}: compare them with what this simulation has."


def _plain(text: str) -> str:
    """Text that may stand in a comment of XML."""
    while "--" in text:
        text = text.replace("--", "- -")
    return text
