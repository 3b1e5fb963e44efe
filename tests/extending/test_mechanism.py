"""A mechanism from a user's own file: found by a diagnosis, kept in a checkpoint, restored, and refused where it is not complete."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app
from greybox_torch.errors import UserError
from greybox_torch.mechanisms.check import check_mechanism
from greybox_torch.mechanisms.library import LIBRARY

EDDY_BRAKE = '''
import greybox_torch as gt


@gt.register
class EddyBrake(gt.Mechanism):
    """−F 2 (v/v_1) / (1 + (v/v_1)²): drags most at the speed v_1, and less beyond."""

    name = "eddy_brake"
    kinds = ("body",)
    needs = ("speed",)
    explanation = "Eddy currents brake, most strongly at one speed."
    source = "D. Schieber, Proc. IEE 121(2), 1974"

    def parameters(self, around):
        reach = around.ranges["speed"].reach
        return [
            gt.Parameter("F", 0.0, around.force_unit, lower=0.0, description="largest drag"),
            gt.Parameter("v_1", 0.3 * reach, around.units.get("speed", ""), lower=0.02 * reach, upper=reach, description="its speed"),
        ]

    def force(self, s, p, z):
        share = s.speed / p.v_1
        return -2.0 * p.F * share / (1.0 + share**2)

    def probes(self, around):
        reach = around.ranges["speed"].reach
        return [gt.Probe(("F",), {"v_1": share * reach}) for share in (0.1, 0.3)]
'''


def with_eddy_brake(folder: Path) -> Path:
    """The motor's recordings made again with an eddy-current brake (F 0.08 N m at 1.2 rad/s), finely integrated."""
    rng = np.random.default_rng(3)
    for file in folder.glob("*.csv"):
        rows = np.loadtxt(file, delimiter=",", skiprows=1)
        speed, found = 0.3, []
        for voltage in rows[:, 0]:
            found.append(speed)
            for _ in range(20):
                brake = 0.16 * (speed / 1.2) / (1 + (speed / 1.2) ** 2)
                speed += 5e-4 * (0.1 * voltage - 0.05 * speed - brake) / 0.02
        rows[:, 1] = np.array(found) + rng.normal(0, 0.01, len(found))
        np.savetxt(file, rows, delimiter=",", header="v,w", comments="", fmt="%.12g")
    return folder


def test_it_is_found_named_kept_and_restored(motor_folder: Callable[..., Path], run_file) -> None:
    folder = with_eddy_brake(motor_folder())
    model = folder / "my_motor.py"
    model.write_text(model.read_text() + EDDY_BRAKE)
    out = folder / "found"
    done = CliRunner().invoke(app, ["diagnose", str(folder / "dataset.toml"), "--out", str(out)])
    assert done.exit_code == 0, done.stderr
    effect, *others = json.loads((out / "verdict.json").read_text())["effects"]
    assert (effect["port"], effect["mechanism"]) == ("rotor", "eddy_brake") and not others
    assert effect["parameters"]["F"]["value"] == pytest.approx(0.08, rel=0.1)
    assert effect["parameters"]["v_1"]["value"] == pytest.approx(1.2, rel=0.1)
    assert "Eddy currents brake" in (out / "report.html").read_text()

    stem = next(out.glob("*.safetensors")).with_suffix("")
    saved = gt.load_saved_model(stem, f"{model}:Motor")
    assert "rotor.eddy_brake.F" in saved.checkpoint.values
    drag = saved.rates({"speed": np.array([1.2])})["speed"] - saved.rates({"speed": np.array([60.0])})["speed"]
    assert np.isfinite(drag).all()

    gt.unregister("eddy_brake")
    model.write_text(model.read_text().replace(EDDY_BRAKE, ""))
    with pytest.raises(UserError) as refused:
        gt.load_saved_model(stem, f"{model}:Motor")
    assert "mechanism 'eddy_brake' is not in the library" in str(refused.value)
    assert "my_motor.py, which registered it, was run before" in str(refused.value)


def test_run_again_it_takes_the_place_of_the_earlier_one(run_file) -> None:
    first = run_file("brake.py", EDDY_BRAKE).EddyBrake
    second = run_file("brake.py", EDDY_BRAKE).EddyBrake
    assert first is not second and LIBRARY["eddy_brake"] is second


def test_a_name_that_is_taken(run_file) -> None:
    run_file("brake.py", EDDY_BRAKE)
    with pytest.raises(UserError, match=r"the name 'eddy_brake' is taken by user_brake.EddyBrake"):
        run_file("other.py", EDDY_BRAKE)
    with pytest.raises(UserError, match="the name 'coulomb_friction' is taken by greybox_torch"):
        run_file("third.py", EDDY_BRAKE.replace("eddy_brake", "coulomb_friction"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "eddy_brake"', 'name = "Eddy brake"', "attribute 'name' is 'Eddy brake'; expected lower-case words"),
        ('name = "eddy_brake"', "", "attribute 'name' is None"),
        (
            'kinds = ("body",)',
            'kinds = ("wheel",)',
            "attribute 'kinds' is ('wheel',); expected a tuple of kinds of port, out of body, ",
        ),
        ('kinds = ("body",)', 'kinds = "body"', "attribute 'kinds' is 'body'"),
        ('needs = ("speed",)', 'needs = ("level",)', "attribute 'needs' has 'level', which a body does not have"),
        ("explanation =", "said =", "attribute 'explanation' is empty"),
        ("def force", "def forced", "does not define force(s, p, z)"),
        ("def parameters", "def those", "does not define parameters(around)"),
        ("def probes", "def looks", "does not define probes(around)"),
        ("p.v_1", "p.v_2", "EddyBrake: force(s, p, z): the equations ask for the parameter 'v_2'"),
        ("share = s.speed", "share = 1 / 0 * s.speed", "force(s, p, z) raised ZeroDivisionError"),
        ("-2.0 * p.F * share", "p.F - 2.0 * share", "its law is not absent where F are zero"),
        ("/ (1.0 + share**2)", "@ share", "its law is not elementwise mathematics"),
        ("-2.0 * p.F *", "-2.0 * p.F * share.reshape(-1, 1) *", "its law is not elementwise mathematics"),
        ('Probe(("F",)', 'Probe(("G",)', "probes(around) has 'G', which is no parameter; expected one of F, v_1"),
        (
            "0.0, around.force_unit, lower=0.0",
            "1.0, around.force_unit, lower=0.5",
            "from zero, which its bounds [0.5, inf] exclude",
        ),
        (
            "    def parameters",
            "    def __init__(self, order):\n        pass\n\n    def parameters",
            "cannot be made without arguments",
        ),
    ],
)
def test_what_is_missing_or_wrong_is_said(run_file, old: str, new: str, message: str) -> None:
    assert old in EDDY_BRAKE
    with pytest.raises(UserError, match=re.escape(message)) as refused:
        run_file("brake.py", EDDY_BRAKE.replace(old, new))
    assert type(refused.value).__name__ == "UserError"
    assert "eddy_brake" not in LIBRARY


def test_what_is_no_mechanism_is_refused() -> None:
    with pytest.raises(UserError, match=r"expected a subclass of greybox_torch.Mechanism"):
        gt.register(dict)  # type: ignore[type-var]


def test_unregister_takes_out_only_what_was_registered(run_file) -> None:
    run_file("brake.py", EDDY_BRAKE)
    gt.unregister("eddy_brake")
    assert "eddy_brake" not in LIBRARY
    for name, why in (("eddy_brake", "is not in the library"), ("gravity", "came with the package")):
        with pytest.raises(UserError, match=why):
            gt.unregister(name)
    assert "gravity" in LIBRARY


@pytest.mark.parametrize("law", [pytest.param(law, id=law.name) for law in LIBRARY.values()])
def test_every_mechanism_of_the_package_passes_the_same_check(law: type[gt.Mechanism]) -> None:
    check_mechanism(law)
