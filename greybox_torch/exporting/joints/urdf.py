"""Effects as URDF: what its joints have words for, which is little.

Source: the URDF specification of ROS, joint element (dynamics, limit).
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from greybox_torch.exporting.joints.counterpart import Counterpart, Law, Place, Said, counterparts
from greybox_torch.exporting.joints.mjcf_laws import coulomb, limited_power, stribeck, viscous
from greybox_torch.exporting.joints.snippet import Snippet, own_values, shown, written
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.mechanics import driven
from greybox_torch.model.ports import Actuator

_HOW = (
    "Add these attributes to the joints of your robot: they are called as the bodies of the model are.",
    "Damping and friction add to what the joint has. Limits are only kept by simulators that read them.",
)


def urdf(model: GreyBoxModel, identifier: str) -> Snippet:
    """What the effects are in URDF, with the values that the model holds."""
    said, unsaid = counterparts(model, LAWS, "URDF")
    root = Element("robot", name=identifier)
    for one in said:
        joint = SubElement(root, "joint", name=one.name)
        dynamics = {"damping": "damping", "frictionloss": "friction"}
        told = {word: shown(one.attributes[name]) for name, word in dynamics.items() if name in one.attributes}
        if told:
            SubElement(joint, "dynamics", told)
        if "effort" in one.attributes:
            SubElement(joint, "limit", effort=shown(one.attributes["effort"]))
    name = f"{identifier}_urdf.xml"
    return Snippet(name, written(root, [*_HOW, own_values(model)], unsaid), tuple(said), tuple(unsaid))


def limited(at: Place) -> Said:
    """A limit of the input as one of the joint's effort."""
    assert isinstance(at.port, Actuator)
    found = driven(at.model, at.port.input)
    if found is None:
        return [], [f"the input {at.port.input} is no force on one body alone, so no joint can be named"]
    body, force = found
    asymmetry = at.values.get("asymmetry", 0.0)
    left = [f"the limit's asymmetry, {asymmetry:.3g}: an effort is that of the weaker direction"] if asymmetry else []
    left += limited_power(at, "limit of effort")
    effort = abs(force) * at.values["limit"] * (1 - abs(asymmetry))
    return [Counterpart("joint", body, {"effort": (effort,)})], left


LAWS: dict[str, Law] = {
    "viscous_friction": viscous,
    "coulomb_friction": coulomb,
    "stribeck_friction": stribeck,
    "torque_saturation": limited,
}
