"""Which recordings, what is concealed from their models, and which answers are right.

An answer is a pair (port, mechanism). ``accept``, ``near`` and ``ports`` mean what they mean in the keys of the simulated cases
(:mod:`experiments.concealed.catalogue.arm`). Where a law contains the one that is concealed (Stribeck friction contains Coulomb friction)
it is accepted. What nature added to these machines besides is nobody's to say: further findings are listed, neither hits nor misses.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from experiments.verdicts.scoring import NOTHING_CONCEALED

HERE = Path(__file__).parent
SHARED = HERE.parents[2] / "shared" / "recordings"

PUBLISHED_ARM = str(SHARED / "robot_arm" / "dataset.toml")
"""The card of the published problem lies beside the recordings of the arm."""

Pair = tuple[str, str]


@dataclass(frozen=True)
class Reading:
    """Where a finding states the concealed quantity: ``parameter`` of ``mechanism``, times ``sign``, over parameter ``over`` if given."""

    mechanism: str
    parameter: str
    sign: float = 1.0
    over: str = ""


@dataclass(frozen=True)
class Concealed:
    """One piece of physics that the model lacks.

    ``parameter`` is its name in the full published model, ``published`` its published value in ``unit`` (None where none was
    published), ``readings`` how findings express it.
    """

    name: str
    parameter: str
    published: float | None
    unit: str
    accept: tuple[Pair, ...]
    near: tuple[Pair, ...]
    ports: tuple[str, ...]
    readings: tuple[Reading, ...]


@dataclass(frozen=True)
class Case:
    """A recording: the card whose model lacks something, what that is, and the card of the full published model.

    ``published_model`` is the full model's file and class, empty where ``published_card`` names it itself; without ``published_card``
    there is no full model to fit. Nothing concealed means that the card's model leaves out nothing that is known, unless the answers lie
    beside the recordings, in ``key.json`` (``answered``).
    """

    name: str
    folder: str
    card: str
    published_card: str = ""
    published_model: str = ""
    concealed: tuple[Concealed, ...] = ()
    answered: bool = False

    @property
    def recordings(self) -> Path:
        """The folder that holds the recordings."""
        return SHARED / self.folder

    @property
    def slug(self) -> str:
        """Its name for a folder."""
        return "".join(c if c.isalnum() else "_" for c in self.name.lower()).strip("_")


def _friction(port: str, level: float, unit: str, *, behind: str = "") -> Concealed:
    """Dry friction of a body; ``behind`` names the body that moves with it but for a twist, where the same law is nearly right.

    That body was added, as near and never as right, after a first run had found the level there.
    """
    names = ("coulomb_friction", "stribeck_friction")
    bodies = (port, behind) if behind else (port,)
    return Concealed(
        "Coulomb friction", "F_c", level, unit,
        accept=tuple((port, name) for name in names),
        near=tuple((b, n) for b in bodies for n in (*names, "presliding_hysteresis") if b != port or n not in names),
        ports=bodies,
        readings=(*(Reading(name, "F_c") for name in names), Reading("presliding_hysteresis", "F")),
    )  # fmt: skip


def _offset(port: str, parameter: str, value: float, unit: str, sign: float) -> Concealed:
    """A constant force: the same at the body and at the actuator."""
    return Concealed(
        "constant force", parameter, value, unit,
        accept=((port, "constant_bias"), ("actuator", "input_bias")),
        near=((port, "coulomb_asymmetry"),),
        ports=(port, "actuator"),
        readings=(Reading("constant_bias", "bias", sign), Reading("input_bias", "bias", sign)),
    )  # fmt: skip


def _stiffness(port: str, parameter: str, value: float | None, unit: str) -> Concealed:
    return Concealed(
        "cubic stiffness", parameter, value, unit,
        accept=((port, "nonlinear_stiffness"),),
        near=((port, "hysteretic_spring"), (port, "backlash")),
        ports=(port,),
        readings=(Reading("nonlinear_stiffness", "k_3"),),
    )  # fmt: skip


def _viscous(value: float, unit: str) -> Concealed:
    return Concealed(
        "viscous friction", "F_v", value, unit,
        accept=(("pivot", "viscous_friction"),),
        near=(("pivot", "quadratic_drag"),),
        ports=("pivot",),
        readings=(Reading("viscous_friction", "c"), Reading("stribeck_friction", "c")),
    )  # fmt: skip


def _coupling_damping() -> Concealed:
    """The library knows no linear damper of a coupling: its dry damping d_0 tanh(r / r_0) is one of d_0 / r_0 while r stays below r_0."""
    return Concealed(
        "arm damping", "d_a", 0.00283465, "N m s/rad",
        accept=(("arm_spring", "nonlinear_damping"),),
        near=(("arm_spring", "hysteretic_spring"), ("arm", "viscous_friction"), ("gearbox", "viscous_friction")),
        ports=("arm_spring", "arm"),
        readings=(Reading("nonlinear_damping", "d_0", over="r_0"),),
    )  # fmt: skip


def _arm(what: str, concealed: Concealed, suffix: str = "", published: str = PUBLISHED_ARM) -> Case:
    name = f"arm without {concealed.name}{suffix}"
    return Case(name, "robot_arm", f"robot_arm_without_{what}.toml", published, "", (concealed,))


def _other(name: str, folder: str, file: str, published: str, *concealed: Concealed) -> Case:
    return Case(name, folder, f"{file}.toml", f"{file}.toml", f"{file}.py:{published}", concealed)


def _alone(name: str, folder: str, file: str, what: str, concealed: Concealed) -> Case:
    """One effect alone left out of the published model."""
    return Case(
        f"{name} without {concealed.name}",
        folder,
        f"{file}_without_{what}.toml",
        f"{file}_complete.toml",
        "",
        (concealed,),
    )


def _complete(name: str, folder: str, card: str) -> Case:
    return Case(f"{name}, published model", folder, card)


def _elsewhere(name: str, folder: str) -> Case:
    """Recordings that come with a card, a model and a key of their own."""
    return Case(name, f"elsewhere/{folder}", str(SHARED / "elsewhere" / folder / "dataset.toml"), answered=True)


def _joint(number: int) -> Case:
    """The double pendulum, one joint's Coulomb friction left out: published as c atan(100 v), a level of c pi/2."""
    level = (0.16, 0.12)[number - 1] * math.pi / 2
    friction = replace(_friction(f"joint{number}", level, "N m"), parameter=f"cf{number}")
    card = f"double_pendulum_without_coulomb_{number}.toml"
    return Case(
        f"double pendulum, joint {number} without Coulomb friction",
        "elsewhere/double_pendulum",
        card,
        concealed=(friction,),
    )


_PENDULUM = {
    "coulomb": _friction("pivot", 0.1839, "N m"),
    "viscous": _viscous(0.0471, "N m s/rad"),
    "offset": _offset("pivot", "offset", -0.0759, "N m", 1.0),
}
_STAGE = {"coulomb": _friction("carriage", 20.3935, "N"), "offset": _offset("carriage", "offset", -3.1648, "N", -1.0)}

CASES = (
    _arm("coulomb", _friction("motor", 0.74302635727901, "N m", behind="gearbox")),
    _arm("coulomb_viscous_free", _friction("motor", 0.74302635727901, "N m", behind="gearbox"), " (all free)", "robot_arm_all_free.toml"),
    _arm("cubic_stiffness", _stiffness("gear_spring", "k_g3", 24.178, "N m/rad^3")),
    _arm("arm_damping", _coupling_damping()),
    _other(
        "EMPS", "emps", "positioning_stage", "PublishedPositioningStage", *_STAGE.values(),
    ),
    *(_alone("EMPS", "emps", "positioning_stage", what, concealed) for what, concealed in _STAGE.items()),
    _complete("EMPS", "emps", "positioning_stage_complete.toml"),
    _other(
        "Silverbox", "silverbox", "silverbox", "PublishedSilverbox",
        _stiffness("spring", "k_3", None, "1/(s V)^2"),
    ),
    _complete("Silverbox", "silverbox", "silverbox_complete.toml"),
    _other(
        "pendulum", "simple_pendulum", "pendulum", "PublishedPendulum", *_PENDULUM.values(),
    ),
    *(_alone("pendulum", "simple_pendulum", "pendulum", what, concealed) for what, concealed in _PENDULUM.items()),
    _complete("pendulum", "simple_pendulum", "pendulum_complete.toml"),
    _elsewhere("double pendulum", "double_pendulum"),
    _joint(1),
    _joint(2),
    _complete("double pendulum", "elsewhere/double_pendulum", str(SHARED / "elsewhere" / "double_pendulum" / "complete.toml")),
    _elsewhere("joint of a seven-axis arm", "arm_joint"),
    Case("joint of a seven-axis arm, torque measured", "elsewhere/arm_joint", "arm_joint_torque.toml", answered=True),
    _elsewhere("cogging motor", "cogging"),
    _elsewhere("screw drive", "screw_drive"),
    _complete("screw drive", "elsewhere/screw_drive", str(SHARED / "elsewhere" / "screw_drive" / "complete.toml")),
    _elsewhere("two tanks", "tanks"),
)  # fmt: skip
"""In the order of the table."""


def key(case: Case) -> dict[str, Any]:
    """The answer key that :func:`experiments.verdicts.scoring.score` reads; the noise of real recordings is not known, so no floor."""
    if case.answered:
        return json.loads((case.recordings / "key.json").read_text(encoding="utf-8"))
    if not case.concealed:
        return dict(NOTHING_CONCEALED)
    return {
        "effects": [c.name for c in case.concealed],
        "accept": [[list(pair) for pair in c.accept] for c in case.concealed],
        "near": [[list(pair) for pair in c.near] for c in case.concealed],
        "ports": [list(c.ports) for c in case.concealed],
        "sigma": 0.0,
    }
