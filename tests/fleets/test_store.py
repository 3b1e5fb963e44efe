"""What counts as done, and what makes it be done again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import greybox_torch.fleets.fingerprint as fingerprints
from greybox_torch.api.fleet_machine import diagnose_machine, without_a_diagnosis
from greybox_torch.data.card import read_card
from greybox_torch.errors import UserError
from greybox_torch.fleets.fingerprint import fingerprint
from greybox_torch.fleets.job import Choices, Job
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.store import ROW, store, store_failure, stored
from greybox_torch.result_names import OF_A_DIAGNOSIS


def of(job: Job) -> str:
    return fingerprint(job, read_card(job.card))


@pytest.mark.parametrize("name", ["dataset.toml", "steps.csv", "my_motor.py"])
def test_every_file_counts(job: Job, name: str) -> None:
    before = of(job)
    with (job.card.parent / name).open("a") as file:
        file.write("\n")
    assert of(job) != before


@pytest.mark.parametrize(
    "choices",
    [
        Choices(settings={"least_gain": 0.05}),
        Choices(time_limit=10.0),
        Choices(seed=1),
        Choices(model="robot_arm"),
        Choices(device="cuda"),
    ],
)
def test_every_choice_counts(job: Job, choices: Choices) -> None:
    assert of(replace(job, choices=choices)) != of(job)


def test_the_version_counts_and_the_place_does_not(job: Job, monkeypatch: pytest.MonkeyPatch) -> None:
    before = of(job)
    job.card.parent.rename(job.card.parent.with_name("moved"))
    moved = replace(job, card=job.card.parent.with_name("moved") / "dataset.toml")
    assert of(moved) == before
    monkeypatch.setattr(fingerprints, "__version__", "99")
    assert of(moved) != before


def test_a_file_that_is_not_there(job: Job) -> None:
    (job.card.parent / "steps.csv").unlink()
    with pytest.raises(UserError, match=r"steps\.csv: no such file"):
        of(job)


def test_a_recording_that_is_not_there_is_told_as_a_diagnosis_tells_it(job: Job) -> None:
    """Seen: "steps.csv: no such file", without the card, the experiment, and the file that is meant."""
    (job.card.parent / "steps.csv").rename(job.card.parent / "step.csv")
    row, kept = diagnose_machine(job)
    again = without_a_diagnosis(job)
    assert not kept and again is not None
    for told in (row.message, again[0].message):
        assert all(part in told for part in ("dataset.toml", '"Steps"', 'did you mean "step.csv"'))


def results(job: Job) -> dict[Path, str | bytes]:
    return {job.folder / name: name for name in OF_A_DIAGNOSIS}


def test_what_is_done_is_found_again(job: Job) -> None:
    row = Row("pump", str(job.card), "nothing", fingerprint="abc", value=float("inf"), parameters={"J": {"value": 1.0}})
    assert stored(job, "abc") is None
    store(job, row, results(job))
    assert stored(job, "abc") == replace(row, value=None)  # strict JSON
    assert stored(job, "other") is None


@pytest.mark.parametrize("lost", [*OF_A_DIAGNOSIS, ROW])
def test_nothing_is_done_where_a_file_is_gone(job: Job, lost: str) -> None:
    store(job, Row("pump", str(job.card), "nothing", fingerprint="abc"), results(job))
    (job.folder / lost).unlink()
    assert stored(job, "abc") is None


@pytest.mark.parametrize(
    "text",
    [
        "{",
        '{"answer": "nothing"}',
        '{"dataset": "a", "card": "b", "answer": "nothing", "new": 1}',
        "[]",
        "7",
        "[" * 200_000,
    ],
)
def test_a_row_of_another_form_is_none(job: Job, text: str) -> None:
    store(job, Row("pump", str(job.card), "nothing", fingerprint=""), results(job))
    (job.folder / ROW).write_text(text)
    assert stored(job, "") is None


def test_rivals_of_an_earlier_run_go(job: Job) -> None:
    first, second = (job.folder / "hypotheses" / f"{k}-rotor-gravity.json" for k in (1, 2))
    row = Row("pump", str(job.card), "found", fingerprint="abc")
    store(job, row, {**results(job), first: "{}", second: "{}"})
    store(job, row, {**results(job), first: "{}"})
    assert list((job.folder / "hypotheses").iterdir()) == [first]


def test_a_failure_leaves_no_earlier_verdict_beside_it(job: Job) -> None:
    rival = job.folder / "hypotheses" / "rival.json"
    store(job, Row("pump", str(job.card), "nothing", fingerprint="abc"), {**results(job), rival: "{}"})
    store_failure(job, Row("pump", str(job.card), "failed", failure="input", fingerprint="abc"))
    assert [path.name for path in job.folder.iterdir()] == [ROW]
    assert stored(job, "abc") is None
