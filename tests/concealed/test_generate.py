from __future__ import annotations

import ast
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from experiments.concealed import generate as generator
from experiments.concealed.catalogue.arm import LIBRARY, OUTSIDE
from experiments.concealed.excitation import EXPERIMENTS
from experiments.concealed.make_demo import make_demo
from experiments.concealed.plant_arm import PARAMETERS

ROOT = Path(__file__).parents[2]
FILES = {"dataset.toml", "key.json", *(f"{name}.csv" for name in EXPERIMENTS)}
SAMPLES = 120


def contents(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


@pytest.fixture(scope="module")
def generated(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("cases")
    arguments = [
        "--cases",
        "3",
        "--seed",
        "5",
        "--samples",
        str(SAMPLES),
        "--effects",
        "none,backlash,gravity+input_lag",
    ]
    assert generator.main([str(out), *arguments]) == 0
    return out


def test_same_seed_same_files(generated: Path, tmp_path: Path):
    plans: list[tuple[str, ...]] = [(), ("backlash",), ("gravity", "input_lag")]
    generator.generate(tmp_path / "again", plans, seed=5, samples=SAMPLES)
    assert contents(tmp_path / "again") == contents(generated)
    generator.generate(tmp_path / "other", plans[:1], seed=6, samples=SAMPLES)
    assert contents(tmp_path / "other")["c000/estimation.csv"] != contents(generated)["c000/estimation.csv"]


def test_a_case_does_not_depend_on_its_company(generated: Path, tmp_path: Path):
    plans: list[tuple[str, ...]] = [(), ("backlash",), ("gravity", "input_lag")]
    generator.generate(tmp_path, plans, seed=5, samples=SAMPLES, block=1)
    assert contents(tmp_path) == contents(generated)


def test_card_tells_what_the_tool_may_know(generated: Path):
    for case in ("c000", "c001", "c002"):
        assert {file.name for file in (generated / case).iterdir()} == FILES
        card = tomllib.loads((generated / case / "dataset.toml").read_text())
        assert card["sample_time"] == 0.0005
        assert card["hold"] == "zoh"
        assert card["channels"]["torque"] == {"column": "u", "unit": "N m"}
        assert card["channels"]["motor_speed"] == {"column": "y", "unit": "rad/s"}
        assert [e["role"] for e in card["experiment"]] == ["estimation", "validation", "validation", "validation"]
        assert [e["file"] for e in card["experiment"]] == [f"{name}.csv" for name in EXPERIMENTS]
        assert card["model"]["name"] == "robot_arm"
        assert tuple(card["model"]["parameters"]) == PARAMETERS
        fixed = {name for name, entry in card["model"]["parameters"].items() if entry.get("fixed")}
        assert fixed == {"J"}


def test_start_values_are_off_by_at_most_fifteen_percent(tmp_path: Path):
    for number in range(50):
        case = generator.draw_case(8, number, (), samples=20)
        ratio = np.array([case.card[name] / case.truth[name] for name in PARAMETERS])
        assert np.all(np.abs(ratio - 1.0) < 0.2)  # a_g may be brought down further, so that an arm is left
        assert np.abs(ratio - 1.0).max() > 0.05
        for values in (case.truth, case.card):
            assert values["a_m"] + values["a_g"] < 0.98


def test_recordings_have_five_digits_and_two_columns(generated: Path):
    lines = (generated / "c001" / "estimation.csv").read_text().splitlines()
    assert lines[0] == "u,y"
    assert len(lines) == SAMPLES + 1
    for number in ",".join(lines[1:]).split(","):
        assert len(number.lstrip("-").partition("e")[0].replace(".", "").lstrip("0")) <= 5


def test_standard_set_has_everything():
    plans = generator.standard_plans(1, 64, 12, 12, 6)
    assert len(plans) == 64
    assert plans.count(()) == 12
    assert sum(len(plan) == 2 for plan in plans) == 12
    singles = {plan[0] for plan in plans if len(plan) == 1}
    assert singles == {*LIBRARY, *OUTSIDE}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(["--effects", "backlsh"], "no effect is called 'backlsh'"), (["--cases", "5"], "--cases 5 is less than")],
)
def test_bad_arguments_are_named(arguments: list[str], message: str, tmp_path: Path, capsys):
    with pytest.raises(SystemExit) as stop:
        generator.main([str(tmp_path / "out"), *arguments])
    assert stop.value.code == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


TOOLS_SIDE = (
    "nominal",
    "against",
    "learned_curve.py",
    "workshop/models",
)  # models for the tool, and those who are measured beside it


def test_generator_shares_no_code_with_the_package():
    concealed = ROOT / "experiments" / "concealed"
    for file in concealed.rglob("*.py"):
        if any(file.is_relative_to(concealed / place) for place in TOOLS_SIDE):
            continue
        for node in ast.walk(ast.parse(file.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [name for name in names if name.partition(".")[0] in ("greybox_torch", "torch")], file


def test_demo_is_what_its_command_makes(tmp_path: Path):
    make_demo(tmp_path)
    demo = ROOT / "greybox_torch" / "demo"
    assert (tmp_path / "dataset.toml").read_text() == (demo / "dataset.toml").read_text()
    made, shipped = (json.loads((folder / "key.json").read_text()) for folder in (tmp_path, demo))
    assert list(made) == list(shipped)
    for name in made:  # another machine's mathematics may differ in the last digit
        assert made[name] == (pytest.approx(shipped[name], rel=1e-12) if name == "truth" else shipped[name]), name
    recordings = sorted(file.name for file in demo.glob("*.csv"))
    assert recordings == sorted(file.name for file in tmp_path.glob("*.csv"))
    for name in recordings:
        made, shipped = (np.loadtxt(folder / name, delimiter=",", skiprows=1) for folder in (tmp_path, demo))
        np.testing.assert_allclose(made, shipped, rtol=2e-3, atol=2e-3)
    assert sum(file.stat().st_size for file in demo.iterdir() if file.is_file()) < 300_000
