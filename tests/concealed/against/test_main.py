"""The command from end to end: results, table, resuming, and input that is at fault."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from experiments.concealed.against.__main__ import main


def arguments(cases: Path, out: Path, *more: str) -> list[str]:
    return [str(cases), str(out), "--methods", "retuned", *more]


def test_results_table_and_resuming(cases: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    verdicts = tmp_path / "verdicts"
    for name in ("drag", "plain"):
        assert main(arguments(cases, tmp_path / "out", "--only", name)) == 0
        made = json.loads((tmp_path / "out" / name / "retuned.json").read_text())
        said = {"port": "rotor", "mechanism": "quadratic_drag", "probability": 0.9}
        verdict = {**made, "can_name": True, "mismatch": name == "drag", "effects": [said] if name == "drag" else []}
        (verdicts / name).mkdir(parents=True)
        (verdicts / name / "verdict.json").write_text(json.dumps(verdict))
    marked = tmp_path / "out" / "drag" / "retuned.json"
    marked.write_text(marked.read_text().replace('"seconds":', '"kept": true, "seconds":'))
    capsys.readouterr()
    assert main(arguments(cases, tmp_path / "out", "--verdicts", str(verdicts))) == 0
    assert json.loads(marked.read_text())["kept"]  # what is there is not made again
    printed = capsys.readouterr().out
    assert "| one effect | greybox diagnose | 1/1 | 0 | 0/1 |" in printed
    assert "**quadratic_drag** at rotor" in printed
    assert "| plain | nothing | nothing missing |" in printed
    rows = json.loads((tmp_path / "out" / "against.json").read_text())
    assert {(r["case"], r["method"]) for r in rows} >= {("drag", "retuned"), ("plain", "greybox diagnose")}


def test_without_keys_there_are_results_and_no_table(cases: Path, tmp_path: Path) -> None:
    shutil.copytree(cases / "plain", tmp_path / "cases" / "plain")
    (tmp_path / "cases" / "plain" / "key.json").unlink()
    assert main(arguments(tmp_path / "cases", tmp_path / "out")) == 0
    assert (tmp_path / "out" / "plain" / "retuned.json").exists()
    assert not (tmp_path / "out" / "against.md").exists()


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--only", "drga"], 'has no case drga (did you mean "drag"?)'),
        (
            ["--methods", "sindi"],
            '--methods: sindi is unknown (did you mean "sindy"?); expected some of retuned,sindy,network',
        ),
    ],
)
def test_arguments_at_fault_end_with_two_and_write_nothing(
    cases: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], message: str
) -> None:
    assert main([str(cases), str(tmp_path / "out"), *more]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_folder_without_cases_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path), str(tmp_path / "out")]) == 2
    assert "expected a folder of cases" in capsys.readouterr().err


def test_a_missing_pysindy_is_said_before_anything_is_run(
    cases: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("experiments.concealed.against.__main__.find_spec", lambda name: None)
    assert main([str(cases), str(tmp_path / "out"), "--methods", "sindy"]) == 2
    assert "extra [proof]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('role = "estimation"', 'role = "validation"', 'no experiment has the role "estimation"'),
        ('name = "', 'nam = "', "nam"),
    ],
)
def test_a_case_at_fault_is_named_and_the_others_are_run(
    cases: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, message: str
) -> None:
    shutil.copytree(cases, tmp_path / "cases")
    card = tmp_path / "cases" / "drag" / "dataset.toml"
    card.write_text(card.read_text().replace(old, new))
    assert main(arguments(tmp_path / "cases", tmp_path / "out")) == 1
    assert message in capsys.readouterr().err
    assert (tmp_path / "out" / "plain" / "retuned.json").exists()
    assert not (tmp_path / "out" / "drag").exists()
