"""What `fit` tells beside the numbers: what the data do not determine, bounds, correlations, profiles."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

import greybox_torch as gt
from greybox_torch.api.fit_summary import warnings
from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.termination import Termination
from tests.commands.fitting import Edit, Make, fit


def test_says_what_the_data_do_not_determine(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "[model.parameters]", "[model.parameters]\nk = { fixed = false }")
    result = fit(folder)
    assert "The data do not determine J, k and b, alone or together" in result.stdout
    assert "undetermined" in result.stdout
    assert json.loads(fit(folder, "--json").stdout)["parameters"]["J"]["std"] is None


def test_says_why_compare_may_find_another_fit(motor_folder: Make, edit: Edit) -> None:
    """Seen: 98.242 % of `fit`, 98.189 % of `compare`, one model on one data set. Where start states are fixed, both begin alike."""
    folder = motor_folder()
    told = fit(folder)
    assert "Refit of Steps and More steps: begun with the start states above" in told.stdout
    (folder / "dataset.toml").open("a").write("\n[model.initial]\nspeed = { value = 0.0, fixed = true }\n")
    assert "Refit of" not in fit(folder).stdout


def test_fit_and_compare_differ_by_start_states_alone(motor_folder: Make) -> None:
    data = gt.load_dataset(motor_folder() / "dataset.toml")
    found = gt.fit(gt.load_model(data.model), data)
    again = gt.compare(data, {"fit": found}).scores
    own = [row for row in found.scores if row["model"] == "refit"]
    for mine, compared in zip(own, again, strict=True):
        same = mine["fit"] == pytest.approx(compared["fit"], abs=1e-6)
        assert same if mine["role"] == "validation" else mine["rmse"] < compared["rmse"]


def test_says_that_nothing_is_free(motor_folder: Make, edit: Edit) -> None:
    """Seen: a card that fixes every parameter; the estimate "converged"."""
    folder = motor_folder()
    edit(folder / "dataset.toml", "J = { value = 0.03 }", "J = { value = 0.03, fixed = true }")
    assert "All parameters are fixed" not in fit(folder).stdout
    edit(folder / "dataset.toml", "upper = 1.0 }", "fixed = true }")
    assert "All parameters are fixed, on the card or in the model: none is estimated." in fit(folder).stdout


def test_says_what_is_at_a_bound(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "upper = 1.0", "lower = 0.07")
    result = fit(folder)
    assert "At a bound: b ≥ 0.07 N m s/rad; " in result.stdout


def test_identifiability_is_told_before_estimating(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "[model.parameters]", "[model.parameters]\nk = { fixed = false }")
    result = fit(folder, "--json")
    assert result.exit_code == 0
    lines = result.stderr.splitlines()
    assert lines[0].startswith("At the start values: J, k and b: only their ratios are determined")
    assert "iteration 1" in lines[1]
    found = json.loads(result.stdout)
    (row,) = found["identifiability"]
    assert (row["kind"], row["parameters"], row["at"]) == ("together", ["J", "k", "b"], ["start", "optimum"])
    assert row["direction"] == pytest.approx([1.0, 1.0, 1.0])
    assert "raising all by the same factor changes nothing" in row["sentence"]
    (note,) = found["statistics"]["notes"]
    assert note["kind"] == "rank_deficient"
    assert "(J, k and b)" in note["sentence"]
    assert found["correlation"] == {"names": ["J", "k", "b"], "matrix": [[None] * 3] * 3}


def test_what_has_no_effect_stays_at_its_start_value(motor_folder: Make, edit: Edit) -> None:
    """Seen: 1.9e86 J for 1 J, saved with the rest, where rounding errors had led it."""
    folder = motor_folder()
    edit(folder / "my_motor.py", "    ports =", '    parameters += [Parameter("unused", 1.0, unit="J")]\n    ports =')
    entry = json.loads(fit(folder, "--json").stdout)["parameters"]["unused"]
    assert (entry["value"], entry["std"], entry["fixed"]) == (1.0, None, False)


def test_nothing_to_tell_of_a_sound_problem(motor_folder: Make) -> None:
    found = json.loads(fit(motor_folder(), "--json").stdout)
    assert (found["identifiability"], found["statistics"]["notes"], found["profiles"]) == ([], [], {})
    assert (found["substeps"], found["precision"]) == (1, "double")
    names, matrix = found["correlation"].values()
    assert names == ["J", "b"]
    assert [matrix[0][0], matrix[1][1]] == pytest.approx([1.0, 1.0])
    assert matrix[0][1] == pytest.approx(matrix[1][0])
    assert -1 < matrix[0][1] < 1


def test_strong_correlations_are_told(motor_folder: Make, edit: Edit) -> None:
    """Two frictions that act alike but for a little."""
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "- p.b * x.speed - p.c * x.speed * (1 + 0.02 * x.speed)")
    edit(folder / "my_motor.py", "    ports =", '    parameters += [Parameter("c", 0.01)]\n    ports =')
    result = fit(folder)
    assert "Estimates that move together (correlation): b and c -0." in result.stdout


def test_bounds_in_the_result(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "upper = 1.0", "lower = 0.07")
    (note,) = json.loads(fit(folder, "--json").stdout)["statistics"]["notes"]
    assert note["kind"] == "at_bound"
    assert note["sentence"].startswith("ended at a bound") and "(b ≥ 0.07 N m s/rad)" in note["sentence"]


def test_profiles(motor_folder: Make) -> None:
    folder = motor_folder()
    result = fit(folder, "--json", "--profile", "J", "--profile", "b", "--profile", "J")
    found = json.loads(result.stdout)
    assert list(found["profiles"]) == ["J", "b"]
    for name, row in found["profiles"].items():
        estimate, deviation = found["parameters"][name]["value"], found["parameters"][name]["std_sandwich"]
        assert row["estimate"] == estimate
        assert [row["lower"], row["upper"]] == pytest.approx(
            [estimate - 1.96 * deviation, estimate + 1.96 * deviation], rel=1e-3
        )
        assert row["colour"] == pytest.approx((deviation / found["parameters"][name]["std"]) ** 2)
        assert len(row["values"]) == len(row["rise"]) > 6
        assert (folder / "out" / f"profile_{name}.png").read_bytes().startswith(b"\x89PNG")
        assert f"{name}: {row['lower']:.5g}" in result.stderr
    assert json.loads((folder / "out" / "fit.json").read_text()) == found


def test_one_advice_where_another_parameter_hides_the_others(motor_folder: Make) -> None:
    """Seen: "do not determine J and k, alone or together: fix one" before "they can elsewhere; an estimate is possible"."""
    data = gt.load_dataset(motor_folder() / "dataset.toml")
    found = gt.fit(gt.load_model(data.model), data).estimation
    assert found.uncertainty is not None
    start = Unidentifiable("start", ("J",), (1.0,), "J: has no effect at these values, but it has elsewhere")
    lost = replace(found, uncertainty=replace(found.uncertainty, undetermined=(0,)), identifiability=(start,))
    assert [line for line in warnings(lost) if line.startswith(("The data do not", "J:"))] == [f"{start.sentence}."]


def test_ctrl_c_in_a_profile_keeps_the_estimate(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: the estimate was lost with the profile."""

    def stopped(*given: object, **settings: object) -> None:
        raise KeyboardInterrupt

    folder = motor_folder()
    monkeypatch.setattr("greybox_torch.api.fit.profile", stopped)
    result = fit(folder, "--profile", "J", "--profile", "b")
    assert result.exit_code == 0
    assert "interrupted: the estimate is kept, without the profile of J, b" in result.stderr
    assert json.loads((folder / "out" / "fit.json").read_text())["profiles"] == {}


def test_substeps_are_told(motor_folder: Make, edit: Edit) -> None:
    """A motor whose lag is a fraction of the sample time takes several steps a sample."""
    folder = motor_folder()
    edit(folder / "dataset.toml", "J = { value = 0.03 }", "J = { value = 0.0004, fixed = true }")
    result = fit(folder, "--json")
    steps = json.loads(result.stdout)["substeps"]
    assert steps > 1
    assert f"Each sample is simulated in {steps} Runge-Kutta steps" in result.stderr


def test_iterations_say_what_they_count(motor_folder: Make) -> None:
    """Seen: "iterations: 20" under a log of many series of more."""
    assert "(of the last descent)" in fit(motor_folder()).stdout


def test_at_the_iteration_limit_it_says_how_to_go_on() -> None:
    assert "`greybox fit DATASET.toml --checkpoint RESULTS`, in Python fit(result, data)" in (
        Termination.iteration_limit.value
    )
