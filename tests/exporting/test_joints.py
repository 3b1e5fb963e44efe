"""Effects as MJCF and URDF: MuJoCo with the snippet beside the model with the effects."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

import numpy as np
import pytest
from rich.console import Console

import greybox_torch as gt
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.model import GreyBoxModel

SIGNALS = ("speed", "position", "deflection", "rate", "input", "output")
STEP = 0.01


def with_effects(model: GreyBoxModel, effects: Mapping[tuple[str, str], Mapping[str, float]]) -> AugmentedModel:
    """Effects by port and mechanism, with their values."""
    around = Surroundings(dict.fromkeys(SIGNALS, Range(-20.0, 20.0, 5.0)), dict.fromkeys(SIGNALS, ""), "N", STEP)
    attached = [
        attach(model, port, law := _law(name, own), "+position" if law.kinematic else "")
        for (port, name), own in effects.items()
    ]
    made = AugmentedModel(model, attached, {port: around for port, _ in effects})
    made.set_values({f"{port}.{name}.{p}": v for (port, name), own in effects.items() for p, v in own.items()})
    return made


def _law(name: str, values: Mapping[str, float]) -> Mechanism:
    forms = {
        "by_direction": ("torque_saturation", "asymmetry"),
        "limited_power": ("torque_saturation", "base_speed"),
        "stiffening": ("backlash", "k_2"),
    }
    asked = (form for form, (law, parameter) in forms.items() if law == name and parameter in values)
    return LIBRARY[name](**dict.fromkeys(asked, True))


def rotor(machines: Path, effects: Mapping[tuple[str, str], Mapping[str, float]]) -> AugmentedModel:
    made = with_effects(gt.load_model(f"{machines / 'small.py'}:Rotor"), effects)
    made.set_values({"b": 0.0})
    return made


def slide(machines: Path, effects: Mapping[tuple[str, str], Mapping[str, float]]) -> AugmentedModel:
    return with_effects(gt.load_model(f"{machines / 'small.py'}:Slide"), effects)


ROTOR = '<joint name="rotor" {own} axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="0.02 0.02 0.02"/>'
SLIDE = '<joint name="slide" type="slide" axis="1 0 0" {own}/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
FORCE = '<actuator><motor name="force" joint="slide"/></actuator>'
VOLTAGE = '<actuator><motor name="voltage" joint="rotor" gear="0.1"/></actuator>'


def error_of(model: AugmentedModel, body: str, inputs: np.ndarray, folder: Path, rest: str = "") -> float:
    """The largest difference of our simulation from MuJoCo's, relative to the largest output."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed (extra [proof])")
    if int(mujoco.__version__.split(".")[0]) < 4 and "needs MuJoCo 4" in str(gt.export(model, to="mjcf")):
        pytest.skip(f"MuJoCo {mujoco.__version__} does not have what this needs")
    (file,) = gt.export(model, to="mjcf", name="effects").save(folder)
    whole = f"""<mujoco><option timestep="0.0005" gravity="0 0 0" integrator="RK4"/><include file="{file}"/>
    <worldbody><body>{body}</body></worldbody>{rest}</mujoco>"""
    (folder / "machine.xml").write_text(whole)
    machine = mujoco.MjModel.from_xml_path(str(folder / "machine.xml"))
    state, outputs = mujoco.MjData(machine), np.zeros(len(inputs))
    drive = mujoco.mj_name2id(machine, mujoco.mjtObj.mjOBJ_ACTUATOR, model.plain.inputs[0].name)
    measured = state.qvel if model.outputs[0].name == "speed" else state.qpos
    for k, u in enumerate(inputs):
        outputs[k] = measured[0]
        state.ctrl[drive] = u
        mujoco.mj_step(machine, state, round(STEP / 0.0005))
    signals = {model.plain.inputs[0].name: inputs, model.outputs[0].name: outputs}
    data = gt.DataSet([gt.Recording.from_arrays("run", signals, sample_time=STEP)], held_out_by_default=False)
    ours = gt.simulate(model, data)["run"][model.outputs[0].name]
    return float(np.abs(ours - outputs).max() / np.abs(outputs).max())


def steps(size: float, seed: int = 3) -> np.ndarray:
    """Of 0.25 s, the first of them zero: before its start MuJoCo's delayed inputs are zero."""
    levels = np.random.default_rng(seed).uniform(-1.0, 1.0, 12)
    levels[0] = 0.0
    return np.repeat(levels, 25) * size


ROTORS = {
    "friction": {
        ("rotor", "viscous_friction"): {"c": 0.02},
        ("rotor", "coulomb_friction"): {"F_c": 0.1, "v_0": 0.05},
    },
    "drag and bias": {("rotor", "quadratic_drag"): {"c": 2e-3}, ("rotor", "constant_bias"): {"bias": 0.1}},
    "lag and offset": {
        ("rotor", "viscous_friction"): {"c": 0.05},
        ("actuator", "input_lag"): {"T": 0.08},
        ("actuator", "input_bias"): {"bias": 1.5},
    },
    "saturation": {("rotor", "viscous_friction"): {"c": 0.05}, ("actuator", "torque_saturation"): {"limit": 4.0}},
    "saturation by direction": {
        ("rotor", "viscous_friction"): {"c": 0.05},
        ("actuator", "torque_saturation"): {"limit": 4.0, "asymmetry": 0.5},
    },
    "gain": {("rotor", "viscous_friction"): {"c": 0.05}, ("actuator", "input_gain"): {"gain_error": 0.2}},
    "delay": {("rotor", "viscous_friction"): {"c": 0.05}, ("actuator", "input_delay"): {"T": 0.05}},
}
SLIDES = {
    "play": ({("spring", "backlash"): {"half_gap": 0.1}}, 'damping="2"'),
    "stiffening spring": ({("spring", "nonlinear_stiffness"): {"k_3": 30.0}}, 'damping="2" stiffness="25"'),
    "spring stiffer one way": (
        {("spring", "nonlinear_stiffness"): {"k_3": 30.0, "k_a": 12.0}},
        'damping="2" stiffness="25"',
    ),
    "stop": ({("slide", "end_stop"): {"k": 200.0, "where": 0.2, "side": 1.0}}, 'damping="2" stiffness="25"'),
}


@pytest.mark.parametrize("name", list(ROTORS))
def test_rotor_beside_mujoco(name: str, machines: Path, tmp_path: Path) -> None:
    drives = any(port == "actuator" for port, _ in ROTORS[name])
    body = ROTOR.format(own='class="rotor"')
    allowed = 0.02 if name == "friction" else 0.01  # MuJoCo's friction sticks, ours changes its sign within v_0
    found = error_of(rotor(machines, ROTORS[name]), body, steps(8.0), tmp_path, "" if drives else VOLTAGE)
    assert found < allowed


@pytest.mark.parametrize("name", list(SLIDES))
def test_slide_beside_mujoco(name: str, machines: Path, tmp_path: Path) -> None:
    effects, own = SLIDES[name]
    assert error_of(slide(machines, effects), SLIDE.format(own=own), steps(15.0), tmp_path, FORCE) < 0.01


LIMIT = {("actuator", "torque_saturation"): {"limit": 4.0, "softness": 0.0}}
LAG = {("actuator", "input_lag"): {"T": 0.05}}
GAIN = {("actuator", "input_gain"): {"gain_error": 0.3}}
BIAS = {("actuator", "input_bias"): {"bias": 0.5}}


def test_laws_of_a_drive_in_the_order_of_mujoco_are_the_models(machines: Path, tmp_path: Path) -> None:
    model = rotor(machines, {("rotor", "viscous_friction"): {"c": 0.05}, **LIMIT, **LAG, **GAIN, **BIAS})
    assert not gt.export(model, to="mjcf", name="effects").rows
    assert error_of(model, ROTOR.format(own='class="rotor"'), steps(8.0), tmp_path) < 0.01


def test_another_order_than_mujocos_is_told(machines: Path) -> None:
    made: Any = gt.export(rotor(machines, {**BIAS, **LAG, **LIMIT}), to="mjcf", name="effects")
    (row,) = made.rows
    assert row == {
        "effect": "voltage",
        "why": "MuJoCo's order is limit, lag, gain, offset; the model's is offset, then lag, then limit",
    }


def test_what_cannot_be_said_is_told(machines: Path, tmp_path: Path) -> None:
    model = rotor(
        machines,
        {("rotor", "torque_ripple"): {"a": 0.1}, ("rotor", "stribeck_friction"): {"F_c": 0.1, "F_s": 0.3, "c": 0.02}},
    )
    for to, attributes in (
        ("mjcf", {"frictionloss": "0.1", "damping": "0.02"}),
        ("urdf", {"friction": "0.1", "damping": "0.02"}),
    ):
        made: Any = gt.export(model, to=to, name="effects")
        assert [row["effect"] for row in made.rows] == ["rotor.torque_ripple", "rotor.stribeck_friction"]
        assert "F_s = 0.3" in made.rows[1]["why"] and "frictionloss" not in made.rows[1]["why"]
        assert "rotor.torque_ripple: " in str(made)
        (file,) = made.save(tmp_path)
        root = ElementTree.parse(file).getroot()
        element = root.find(".//joint" if to == "mjcf" else ".//dynamics")
        assert element is not None
        assert element.attrib == attributes
        told = json.loads(made.to_json(tmp_path))
        assert told["files"] == [str(file)]
        assert told["not_said"] == made.rows
        assert "rotor.torque_ripple" in made._repr_html_() and "<pre>" in made._repr_html_()


@pytest.mark.parametrize("to", ["mjcf", "urdf"])
def test_the_models_own_values_are_told_as_those_beside_the_effects(
    to: Literal["mjcf", "urdf"], machines: Path
) -> None:
    """Seen: J as estimated with the effects, told as what "the model without effects" holds, which another column of the results is."""
    text = str(gt.export(rotor(machines, {("rotor", "coulomb_friction"): {"F_c": 0.1}}), to=to))
    assert "Beside these effects, the model's own parameters are J = 0.02 kg m^2" in text
    assert "without effects" not in text
    assert ("frictionloss" in text) == (to == "mjcf"), "seen: MJCF's word in what URDF has no word for"


def test_play_whose_contact_grows_stiffer_is_told_not_to(machines: Path) -> None:
    made: Any = gt.export(slide(machines, {("spring", "backlash"): {"half_gap": 0.1, "k_2": 40.0}}), to="mjcf")
    assert ["k_2 = 40" in row["why"] for row in made.rows] == [False, True]
    plain: Any = gt.export(slide(machines, {("spring", "backlash"): {"half_gap": 0.1}}), to="mjcf")
    assert not any("k_2" in row["why"] for row in plain.rows)


def test_steps_are_those_of_the_simulator(machines: Path) -> None:
    with pytest.raises(gt.UserError, match=r"step: found 0\.001, mjcf has attributes alone"):
        gt.export(rotor(machines, {("rotor", "viscous_friction"): {"c": 0.1}}), to="mjcf", step=1e-3)


@pytest.mark.parametrize("to", ["mjcf", "urdf"])
def test_without_effects_there_is_nothing_to_write(to: str, machines: Path) -> None:
    """Seen: a file with nothing but its comments, and not a word."""
    with pytest.raises(gt.UserError, match=f"no effects, so there is nothing to write as {to}"):
        gt.export(gt.load_model(f"{machines / 'small.py'}:Tank"), to=to)


def test_a_tank_has_no_joints(machines: Path) -> None:
    around = Surroundings({"level": Range(0.0, 1.0, 0.5)}, {"level": "m"}, "m^3/s", 1.0)
    plain = gt.load_model(f"{machines / 'small.py'}:Tank")
    laws = ("constant_bias", "linear_leak")
    model = AugmentedModel(plain, [attach(plain, "tank", LIBRARY[name]()) for name in laws], {"tank": around})
    made = gt.export(model, to="mjcf")
    assert made.snippet.said == ()
    assert len(made.rows) == 2
    assert made.to_dict()["sentence"].startswith("Nothing of the effects of Tank can be expressed in mjcf")
    console = Console(record=True, width=200)
    made.show(console)
    assert made.sentence[:60] in console.export_text()


@pytest.mark.parametrize(("asymmetry", "effort"), [({}, 0.4), ({"asymmetry": -0.25}, 0.3)])
def test_limits_in_urdf(machines: Path, asymmetry: dict[str, float], effort: float) -> None:
    """The rotor's voltage is a torque of 0.1 N m/V, which the joint's effort is limited to: that of the weaker direction."""
    model = rotor(machines, {("actuator", "torque_saturation"): {"limit": 4.0, **asymmetry}})
    made = gt.export(model, to="urdf")
    root = ElementTree.fromstring(made.snippet.text)
    assert bool(made.rows) == bool(asymmetry)
    limit = root.find("joint[@name='rotor']/limit")
    assert limit is not None
    assert float(limit.attrib["effort"]) == pytest.approx(effort)


@pytest.mark.parametrize(("to", "word"), [("mjcf", "a ctrlrange"), ("urdf", "a limit of effort")])
def test_a_limit_that_falls_with_speed_is_said_to_be_left_out(
    machines: Path, to: Literal["mjcf", "urdf"], word: str
) -> None:
    falling = {"limit": 4.0, "softness": 0.0, "base_speed": 12.0}
    made = gt.export(rotor(machines, {("actuator", "torque_saturation"): falling}), to=to)
    (row,) = made.rows
    assert f"base speed, 12: it falls as 1 / speed beyond, {word} does not" in str(row)
