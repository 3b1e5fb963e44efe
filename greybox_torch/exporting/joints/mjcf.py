"""Effects as MJCF: a file to be included, with classes of joints, tendons and actuators."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement

from greybox_torch.exporting.joints.counterpart import Attribute, Counterpart, Unsaid, counterparts
from greybox_torch.exporting.joints.mjcf_laws import LAWS
from greybox_torch.exporting.joints.snippet import Snippet, own_values, shown, written
from greybox_torch.model import GreyBoxModel

_HOW = (
    "Include this file, and call the joints of your model as bodies and couplings are called here (or change the names here).",
    "Joints: give them the class of their name. Where they have damping or frictionloss of their own, add these up: attributes of a joint "
    "go before those of its class.",
    "Actuators take the place of yours of the same input; tendons add to what the joint has.",
)
_IN_ORDER = {"ctrlrange": "limit", "dyntype": "lag", "relative_gain": "gain", "biasprm": "offset"}
"""What MuJoCo does with a delayed input, one after the other, by the attribute that says it."""


def mjcf(model: GreyBoxModel, identifier: str) -> Snippet:
    """What the effects are in MJCF, with the values that the model holds."""
    said, unsaid = counterparts(model, LAWS, "MJCF")
    unsaid += _orders(said)
    root = Element("mujocoinclude")
    joints = [one for one in said if one.element == "joint"]
    if joints:
        classes = SubElement(SubElement(root, "default"), "default", {"class": identifier})
        for one in joints:
            _element(SubElement(classes, "default", {"class": one.name}), "joint", one.attributes)
    for one in (one for one in said if one.element == "tendon"):
        attributes = {name: value for name, value in one.attributes.items() if name != "joint"}
        fixed = _element(_section(root, "tendon"), "fixed", {"name": one.name, **attributes})
        SubElement(fixed, "joint", joint=shown(one.attributes["joint"]), coef="1")
    for one in (one for one in said if one.element in ("actuator", "constant")):
        _element(_section(root, "actuator"), "general", {"name": one.name, **_drive(one)})
    name = f"{identifier}_mjcf.xml"
    return Snippet(name, written(root, [*_HOW, own_values(model)], unsaid), tuple(said), tuple(unsaid))


def _drive(one: Counterpart) -> dict[str, Attribute]:
    """Attributes of an actuator, its gain with the relative error of the gain."""
    attributes = dict(one.attributes)
    relative = attributes.pop("relative_gain", (0.0,))
    gain = attributes.get("gainprm", (0.0,))
    assert not isinstance(relative, str) and not isinstance(gain, str)
    return {**attributes, "gainprm": (gain[0] * (1.0 + relative[0]),)}


def _orders(said: list[Counterpart]) -> list[Unsaid]:
    """The actuators whose effects stand in another order than MuJoCo's."""
    found = []
    for one in (one for one in said if one.element == "actuator"):
        kinds = [kind for kind in one.attributes if kind in _IN_ORDER]
        if kinds != [kind for kind in _IN_ORDER if kind in kinds]:
            own = ", then ".join(_IN_ORDER[kind] for kind in kinds)
            why = f"MuJoCo's order is {', '.join(_IN_ORDER.values())}; the model's is {own}"
            found.append(Unsaid(one.name, why))
    return found


def _section(root: Element, name: str) -> Element:
    found = root.find(name)
    return SubElement(root, name) if found is None else found


def _element(parent: Element, name: str, attributes: Mapping[str, Attribute]) -> Element:
    return SubElement(parent, name, {key: shown(value) for key, value in attributes.items()})
