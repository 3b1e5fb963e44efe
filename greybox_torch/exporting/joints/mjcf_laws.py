"""The laws that MJCF has elements for, by the mechanism's name.

Source: MuJoCo documentation, XML reference (joint, tendon/fixed, actuator/general), and MuJoCo 4.0 itself, which has polynomials of damping
(odd ones) and stiffness, and actuators with delays.
"""

from __future__ import annotations

import math

from greybox_torch.exporting.joints.counterpart import Attribute, Counterpart, Law, Place, Said
from greybox_torch.model import Body, Coupling
from greybox_torch.model.mechanics import driven, stiffness
from greybox_torch.model.ports import Actuator

FAR = 1e6
"""An end of a dead band that nothing reaches, in rad or m."""
SHORTEST_STEP = 1e-4
"""Seconds of a simulation's time step that delays have samples enough for."""
CLAMPS = 0.02
"""Softness of a saturation up to which it is as good as a clamp."""
NEWER = "needs MuJoCo 4"
_UNITS = ("", "rad/s", "m/s")


def viscous(at: Place) -> Said:
    return _joint(at, {"damping": (at.values["c"],)})


def coulomb(at: Place) -> Said:
    return _joint(at, {"frictionloss": (at.values["F_c"],)}, _sticks(at))


def stribeck(at: Place) -> Said:
    peak = f"the extra level F_s = {at.values['F_s']:.6g} below v_s = {at.values['v_s']:.6g}: a joint's dry friction is one level"
    return _joint(at, {"frictionloss": (at.values["F_c"],), "damping": (at.values["c"],)}, peak)


def drag(at: Place) -> Said:
    return _joint(at, {"damping": (0.0, at.values["c"])}, f"damping with two coefficients {NEWER}")


def body_bias(at: Place) -> Said:
    if not isinstance(at.port, Body):
        return [], ["a flow is no force on a joint"]
    known = _unit_problem(at)
    force: dict[str, Attribute] = {
        "joint": at.port.name,
        "biastype": "affine",
        "biasprm": (at.values["bias"], 0.0, 0.0),
    }
    return ([], [known]) if known else ([Counterpart("constant", f"{at.port.name}_bias", force)], [])


def end_stop(at: Place) -> Said:
    """A tendon along the joint that is slack up to the stop."""
    problem = _unit_problem(at)
    if problem:
        return [], [problem]
    if "side" not in at.values:
        slack, side = (at.values["low"], at.values["high"]), "both"
    elif at.values["side"] > 0.0:
        slack, side = (-FAR, at.values["where"]), "above"
    else:
        slack, side = (at.values["where"], FAR), "below"
    spring: dict[str, Attribute] = {"joint": at.port.name, "stiffness": (at.values["k"],), "springlength": slack}
    stop = Counterpart("tendon", f"{at.port.name}_stop_{side}", spring)
    damping = f"the stop's damping c = {at.values['c']:.6g}: that of a tendon acts off the stop as well"
    return [stop], [damping] if at.values["c"] else []


def backlash(at: Place) -> Said:
    centre, gap = at.values.get("centre", 0.0), at.values["half_gap"]
    ends = (centre - gap, centre + gap)
    own = stiffness(at.model, at.port) if isinstance(at.port, Coupling) else None
    grows = at.values.get("k_2")
    odd = [f"the part k_2 p|p| beyond the gap with k_2 = {grows:.6g}: MJCF has p^2, which is not odd"] if grows else []
    if own is None:
        band = f'springlength="{ends[0]:.6g} {ends[1]:.6g}"'
        return [], [
            f"the stiffness of this coupling cannot be read from the model: write a fixed tendon with yours and {band}",
            *odd,
        ]
    left = [
        f"the tendon takes the place of the joint's own spring ({own:.6g}): take that out; what it has beyond a linear spring is not in it",
        *odd,
    ]
    if at.values.get("damping"):
        left.append(
            f"what the damper loses within the gap, {at.values['damping']:.6g}: a joint's damping acts everywhere"
        )
    return [_tendon(at, {"stiffness": (own,), "springlength": ends})], left


def spring(at: Place) -> Said:
    v = at.values
    polynomial = (0.0, v["k_a"], v["k_3"])
    left = [f"stiffness with three coefficients {NEWER}"] if any(polynomial) else []
    if v["k_2"]:
        left.append(f"the part k_2 d|d| with k_2 = {v['k_2']:.6g}: MJCF has d^2, which is not odd")
    if v["F_0"]:
        left.append(f"the part F_0 tanh(d / d_0) with F_0 = {v['F_0']:.6g}, d_0 = {v['d_0']:.6g}")
    said = [_tendon(at, {"stiffness": polynomial, "springlength": (0.0, 0.0)})] if any(polynomial) else []
    return said, left


def damper(at: Place) -> Said:
    v = at.values
    attributes: dict[str, Attribute] = {}
    left = []
    if v["d_2"]:
        attributes["damping"] = (0.0, v["d_2"])
        left.append(f"damping with two coefficients {NEWER}")
    if v["d_0"] > 0.0:
        attributes["frictionloss"] = (v["d_0"],)
    elif v["d_0"]:
        left.append(f"a dry part that drives, d_0 = {v['d_0']:.6g}")
    for difference in ("d_a", "d_b"):
        if v.get(difference):
            left.append(f"the difference between the directions, {difference} = {v[difference]:.6g}")
    return ([_tendon(at, attributes)] if attributes else []), left


def gain(at: Place) -> Said:
    return _actuator(at, {"relative_gain": (at.values["gain_error"],)})


def input_bias(at: Place) -> Said:
    found = driven(at.model, _input(at))
    force = 0.0 if found is None else found[1] * at.values["bias"]
    return _actuator(at, {"biastype": "affine", "biasprm": (force, 0.0, 0.0)})


def saturation(at: Place) -> Said:
    limit, softness = at.values["limit"], at.values["softness"]
    left = [f"the softness of the limit, {softness:.3g}: a ctrlrange is a clamp"] if softness > CLAMPS else []
    left += limited_power(at, "ctrlrange")
    more = at.values.get("asymmetry", 0.0)
    return _actuator(at, {"ctrllimited": "true", "ctrlrange": (-limit * (1 - more), limit * (1 + more))}, *left)


def limited_power(at: Place, word: str) -> list[str]:
    """What a constant limit, called ``word``, leaves out of one that falls with speed."""
    base = at.values.get("base_speed")
    return (
        [] if base is None else [f"the limit's base speed, {base:.3g}: it falls as 1 / speed beyond, a {word} does not"]
    )


def lag(at: Place) -> Said:
    if "damping" in at.values:
        return [], ["a lag of second order: an actuator's filter is of first order"]
    return _actuator(at, {"dyntype": "filterexact", "dynprm": (at.values["T"],)})


def delay(at: Place) -> Said:
    late = at.values["T"]
    samples = math.ceil(late / SHORTEST_STEP) + 2
    left = f"a delay {NEWER}; its nsample is one for each time step, enough for steps of {SHORTEST_STEP:g} s and more"
    attributes: dict[str, Attribute] = {"delay": (late,), "nsample": str(samples), "interp": "linear"}
    return _actuator(at, attributes, left) if late > 0.0 else ([], [])


LAWS: dict[str, Law] = {
    "viscous_friction": viscous,
    "coulomb_friction": coulomb,
    "stribeck_friction": stribeck,
    "quadratic_drag": drag,
    "constant_bias": body_bias,
    "end_stop": end_stop,
    "backlash": backlash,
    "nonlinear_stiffness": spring,
    "nonlinear_damping": damper,
    "input_gain": gain,
    "input_bias": input_bias,
    "torque_saturation": saturation,
    "input_lag": lag,
    "input_delay": delay,
}


def _joint(at: Place, attributes: dict[str, Attribute], *left: str) -> Said:
    problem = _unit_problem(at)
    return ([], [problem]) if problem else ([Counterpart("joint", at.port.name, attributes)], list(left))


def _tendon(at: Place, attributes: dict[str, Attribute]) -> Counterpart:
    return Counterpart("tendon", at.port.name, {"joint": _wound(at), **attributes})


def _wound(at: Place) -> str:
    """The joint whose position is a coupling's deflection: a body's, or one that is called as the coupling is."""
    assert isinstance(at.port, Coupling)
    bodies = (port for port in at.model.ports if isinstance(port, Body) and isinstance(port.position, str))
    return next((body.name for body in bodies if body.position == at.port.deflection), at.port.name)


def _actuator(at: Place, attributes: dict[str, Attribute], *left: str) -> Said:
    found = driven(at.model, _input(at))
    if found is None:
        return [], [f"the input {_input(at)} is no force on one body alone, so no joint can be named for an actuator"]
    body, force = found
    shown: dict[str, Attribute] = {"joint": body, "gainprm": (force,), **attributes}
    return [Counterpart("actuator", _input(at), shown)], list(left)


def _input(at: Place) -> str:
    assert isinstance(at.port, Actuator)
    return at.port.input


def _sticks(at: Place) -> str:
    return (
        f"the speed v_0 = {at.values['v_0']:.6g} within which the force changes its sign: a joint's dry friction sticks"
    )


def _unit_problem(at: Place) -> str:
    """Why a body is none of MJCF's joints; empty where it is one."""
    assert isinstance(at.port, Body)
    speed = at.port.speed
    unit = next((s.unit for s in at.model.states if s.name == speed), "")
    return "" if unit in _UNITS else f"the speed of {at.port.name} is in {unit}; joints move in rad or m"
