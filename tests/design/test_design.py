"""The next recording for two hypotheses that the recordings so far do not tell apart."""

from __future__ import annotations

import csv
import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.api.hypotheses import hypothesis_files, read_hypotheses
from greybox_torch.checkpoint import checkpoint_files
from greybox_torch.cli import app
from greybox_torch.data import Channel
from greybox_torch.errors import ArgumentError, UserError
from greybox_torch.experiment_design.limits import EVERY_INPUT
from greybox_torch.files import write_all

from .conftest import sticking


@pytest.fixture(scope="module")
def designed(undecided) -> gt.DesignResult:
    return gt.design(undecided)


@pytest.fixture
def results(undecided, tmp_path: Path) -> Path:
    """The folder of that diagnosis, but for its report."""
    checkpoint = undecided._checkpoint()
    folder = tmp_path / "results"
    write_all({**checkpoint_files(folder / "model", checkpoint), **hypothesis_files(folder, undecided, checkpoint)})
    return folder


def test_it_reverses_where_the_recordings_did_not(designed) -> None:
    (speed,) = (y[:, 0] for y in designed.outputs[:1])
    assert designed.inputs["voltage"].min() < -0.5 and speed.min() < -0.5
    assert designed.expected.after == 0.97 > designed.expected.before[0]
    assert designed.needed < designed.seconds == pytest.approx(2.0)
    assert designed.alike == [] and "probability of 0.97" in designed.sentence


def test_the_limits_hold_under_every_hypothesis_and_on_the_machine(designed) -> None:
    voltage = designed.inputs["voltage"]
    assert np.abs(voltage).max() <= 3.0
    for outputs in (*designed.outputs, sticking(voltage, start=2.0)[:, None]):
        assert np.abs(outputs).max() <= 7.0


def test_the_recording_decides(designed, one_way) -> None:
    """The machine, simulated by code that the package does not share, is recorded with the input: its law fits both, the other does not."""
    voltage = designed.inputs["voltage"]
    speed = sticking(voltage, start=2.0) + np.random.default_rng(3).normal(0, 0.01, len(voltage))
    new = gt.Recording.from_arrays("designed", {"voltage": voltage, "speed": speed}, sample_time=0.01)
    both = gt.DataSet([*one_way.recordings, new], hold="zoh")
    left = {}
    for name, kept in zip(designed.names, designed.hypotheses, strict=True):
        left[name] = gt.fit(kept, both).to_dict()["statistics"]["mse"]
    assert left["Coulomb friction at rotor"] < 0.5 * left["constant bias at rotor"]


def test_a_random_input_of_the_same_power_says_less_or_nothing_more(designed) -> None:
    assert designed.expected.random is None or designed.expected.random <= designed.expected.after + 1e-6


def test_the_same_seed_gives_the_same_input(undecided, designed) -> None:
    again = gt.design(undecided)
    np.testing.assert_array_equal(again.inputs["voltage"], designed.inputs["voltage"])
    assert again.to_json() == designed.to_json()


def test_an_input_that_is_kept_is_no_excitation(undecided) -> None:
    kept = gt.design(undecided, seconds=0.5, limits={"voltage": {"lower": 2.0, "upper": 2.0}})
    assert (kept.inputs["voltage"] == 2.0).all()
    assert kept.content(Path("next"))["inputs"] == {"voltage": {"kind": "constant", "value": 2.0}}


def test_precision(undecided) -> None:
    found = gt.design(undecided, precision="J", seconds=1.0)
    assert found.after is not None and found.before is not None and 0 < found.after < found.before
    assert "standard deviation of J from" in found.sentence and found.sentence.endswith(" kg m^2.")
    assert found.sentence.startswith("1 s of ") and EVERY_INPUT not in found.notes
    long = replace(found, time=np.arange(3600.0))
    assert long.sentence.startswith("3600 s of ")  # seen: 3.6e+03 s
    ranges = {**found.limits.inputs, "room": found.limits.inputs["voltage"]}
    inputs = {**found.inputs, "room": found.inputs["voltage"]}
    runs = [replace(r, signals={**r.signals, "room": r.signals["voltage"]}) for r in found.data.recordings]
    data = replace(
        found.data, recordings=tuple(runs), channels={**found.data.channels, "room": Channel("room", "degC")}
    )
    two = replace(found, data=data, limits=replace(found.limits, inputs=ranges), inputs=inputs)
    assert EVERY_INPUT in two.notes
    correlated = replace(found, memory=510.0)
    assert any("correlated over up to 510 samples, and so many count as one" in line for line in correlated.notes)
    assert not any("count as one" in line for line in replace(found, memory=1.0).notes)
    told = found.to_dict()
    assert told["deviation"]["after"] == found.after and "hypotheses" not in told


def test_command(results: Path) -> None:
    result = CliRunner().invoke(app, ["design", str(results), "--json", "--seconds", "1"])
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert told["schema"] == "greybox-design/1" and told["seconds"] == pytest.approx(1.0)
    assert [h["name"] for h in told["hypotheses"]] == ["Coulomb friction at rotor", "constant bias at rotor"]
    folder = results / "design"
    assert sorted(p.name for p in folder.iterdir()) == ["design.csv", "design.png", "next.toml"]
    with (folder / "design.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["time [s]", "voltage [V]"] and len(rows) == 100
    card = tomllib.loads((folder / "next.toml").read_text())
    assert card["experiment"][0]["file"] == "recorded.csv" and card["channels"]["speed"]["unit"] == "rad/s"


def test_the_card_reads_what_is_recorded(designed, tmp_path: Path) -> None:
    designed.save(tmp_path)
    voltage = designed.inputs["voltage"]
    rows = np.column_stack([voltage, sticking(voltage)])
    np.savetxt(tmp_path / "recorded.csv", rows, delimiter=",", header="voltage,speed", comments="")
    data = gt.load_dataset(tmp_path / "next.toml")
    np.testing.assert_allclose(data.recordings[0].signals["voltage"][:50], voltage[:50])


def test_what_a_folder_keeps_is_what_the_diagnosis_had(results: Path, undecided) -> None:
    held = read_hypotheses(results)
    ((first, second),) = held.findings
    assert (first.name, second.name) == ("Coulomb friction at rotor", "constant bias at rotor")
    assert first.model.values() == pytest.approx(dict(undecided.found.rivals[0].values))
    assert second.starts == {"steps": {"speed": 2.0}}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--precision", "mass"], "--precision mass: expected a free parameter"),
        (
            ["--precision", "F_c"],
            '--precision F_c: expected a free parameter (did you mean "rotor.coulomb_friction.F_c"?)',
        ),
        (["--seconds", "0"], "--seconds"),
        (["--model", "no.py:Motor"], "no.py"),
    ],
)
def test_options_at_fault(results: Path, options: list[str], message: str) -> None:
    result = CliRunner().invoke(app, ["design", str(results), *options])
    assert result.exit_code == 2 and message in result.output
    told = CliRunner().invoke(app, ["design", str(results), "--json", *options])
    assert (told.exit_code, told.stdout) == (2, "") and message in told.stderr
    assert not (results / "design").exists()


def test_a_finding_that_is_decided_is_no_error(results: Path) -> None:
    """Seen: exit code 2, as if the user had done something wrong. The verdict's own reason is told."""
    file = results / "hypotheses.json"
    content = json.loads(file.read_text())
    own, rival = content["findings"][0]
    own |= {"probability": 0.97, "in_verdict": 0.5, "limited": ["a free curve does better in its place"]}
    file.write_text(json.dumps({**content, "findings": [[own, {**rival, "probability": 1e-6}]]}))
    result = CliRunner().invoke(app, ["design", str(results)])
    assert result.exit_code == 4 and "nothing to design: of the named hypotheses" in result.stderr
    assert "error" not in result.stderr and "another reason: a free curve does better in its place" in result.stderr
    told = CliRunner().invoke(app, ["design", str(results), "--json"])
    assert told.exit_code == 4 and told.stdout, "seen: rc 4, and nothing for a script to read"
    for_scripts = json.loads(told.stdout)
    assert for_scripts["schema"] == "greybox-design/1" and for_scripts["nothing_to_do"].startswith(
        "nothing to design: of"
    )
    assert for_scripts["nothing_to_do"] in told.stderr.replace("\n", " ") and result.stdout == ""


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no such file; expected results of greybox diagnose"),
        ("{", "not JSON"),
        ("[" * 200_000, "not JSON: nested too deeply"),
        ("1" * 5000, "not JSON: Exceeds the limit"),
        ("[]", "\"schema\": found 'list'"),
        ('{"schema": "greybox-hypotheses/1", "dataset": null}', "recordings in memory"),
        ('{"schema": "greybox-hypotheses/1", "dataset": "nowhere.toml"}', "nowhere.toml"),
    ],
)
def test_results_at_fault(results: Path, content: str | None, message: str) -> None:
    file = results / "hypotheses.json"
    file.unlink() if content is None else file.write_text(content)
    result = CliRunner().invoke(app, ["design", str(results)])
    assert result.exit_code == 2 and message in result.output


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        ({"checkpoint": None}, "no such file"),
        ({"probability": "abc"}, "damaged: ValueError: could not convert string to float: 'abc'"),
        ({"in_verdict": "abc"}, "damaged: ValueError"),
        ({"initial": {"steps": 2.0}}, "damaged: AttributeError"),
        ({"initial": {"steps": {"speed": None}}}, "damaged: TypeError"),
    ],
)
def test_damaged_hypothesis(results: Path, damage: dict[str, object], message: str) -> None:
    """Seen: tracebacks, of a probability that is no number and of start states that are none."""
    file = results / "hypotheses.json"
    content = json.loads(file.read_text())
    content["findings"][0][0] |= damage
    file.write_text(json.dumps(content))
    with pytest.raises(UserError, match=message):
        gt.design(results)


def test_damaged_list(results: Path) -> None:
    file = results / "hypotheses.json"
    content = json.loads(file.read_text())
    del content["findings"][0][0]["checkpoint"]
    file.write_text(json.dumps(content))
    with pytest.raises(UserError, match="damaged: KeyError"):
        gt.design(results)


def test_nothing_to_tell_apart(undecided) -> None:
    from dataclasses import replace

    alone = replace(undecided, found=replace(undecided.found, rivals=undecided.found.rivals[:1]))
    with pytest.raises(UserError, match="left no rivals to tell apart"):
        gt.design(alone)


def test_limits_that_nothing_keeps(undecided) -> None:
    with pytest.raises(UserError, match="no input was found under which every hypothesis keeps"):
        gt.design(undecided, limits={"speed": {"lower": 100.0, "upper": 101.0}})


def test_arguments_at_fault() -> None:
    with pytest.raises(ArgumentError, match=r"^found: an object of type int, expected the result of diagnose"):
        gt.design(3)  # type: ignore[arg-type]
