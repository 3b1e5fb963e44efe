"""Diagnoses timed: what a pass is for, the cases, and what is asked of them."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from experiments.speed.diagnosis.cases import ARM, DEMO, PENDULUM, cases, development_cases
from experiments.speed.diagnosis.profiled import CARRYING, PURPOSES, leave_out_installed, purpose_of
from experiments.speed.diagnosis.timed import Timed, checked_out, stood_from
from experiments.speed.rows.diagnosis import _asked, _entry, _leading, _targets

PACKAGE = Path(__file__).resolve().parents[2] / "greybox_torch"


def called_from(*places: tuple[str, str]) -> str:
    """The purpose of what runs in functions of these files, the outermost first."""

    def here() -> str:
        return purpose_of(sys._getframe(1))

    call = here
    for file, function in reversed(places):
        scope: dict = {}
        exec(compile(f"def {function}(inner):\n    return inner()", f"/somewhere/{file}", "exec"), scope)
        call = (lambda outer, inner: lambda: outer(inner))(scope[function], call)
    return call()


def test_the_innermost_purpose_counts_and_carrying_is_told_apart() -> None:
    assert called_from(("pipeline.py", "diagnose")) == "other"
    assert called_from(("explore.py", "_from_given"), ("rank.py", "in_full")) == "finalists"
    assert called_from(("rank.py", "tried"), ("carried_starts.py", "carried_starts")) == "trials, carrying states"


@pytest.mark.parametrize(("file", "function"), sorted({*PURPOSES, *CARRYING} - {("carried.py", "carried_starts")}))
def test_every_purpose_is_a_function_of_the_package(file, function) -> None:
    assert any(f"def {function}(" in path.read_text() for path in PACKAGE.rglob(file))


def test_targets_count_what_did_not_end_as_missed() -> None:
    names = [DEMO, "d01", "d02", "d03", ARM, PENDULUM]
    assert development_cases(names) == ["d01", "d02", "d03"]
    found = {t.text: t for t in _targets({"d01": 3.0, "d02": 8.0, ARM: 20.0}, names)}
    assert found["development cases, median"].measured == 8.0
    assert [found[text].met for text in ("development cases, slowest", ARM, PENDULUM)] == [False, True, False]


def test_some_cases_are_asked_for_by_name() -> None:
    assert list(_asked([DEMO])) == [DEMO]
    assert _asked(()) == cases()
    with pytest.raises(ValueError, match="--cases: no case is called dmo; expected some of demo"):
        _asked(["dmo"])


def test_a_case_is_told_with_what_took_longest_and_how_it_compares() -> None:
    passes = {"trials": {"seconds": 2.0}, "polishing": {"seconds": 3.0}}
    slow, fast = (Timed(s, s + 4.0, {}, passes, "rotor coulomb_friction", 1.5) for s in (10.0, 5.0))
    entry = _entry("demo, at abc", slow, fast)
    assert (entry.seconds, entry.compile_seconds, entry.ours) == (10.0, 4.0, False)
    assert (
        entry.note == "2.00 times as long; rotor coulomb_friction (leads from 1.5 s on); polishing 3.0 s, trials 2.0 s"
    )
    assert _entry("demo", None).seconds is None


def test_a_finding_leads_from_when_nothing_else_took_its_place() -> None:
    lag, delay, stop = ("actuator", "input_lag"), ("sensor", "output_delay"), ("cart", "end_stop")
    effect = {"port": "actuator", "mechanism": "input_lag"}
    heard = [(1.0, [lag]), (2.0, [stop]), (3.0, [delay]), (4.0, []), (5.0, [stop, lag])]
    assert stood_from(heard, {"effects": [effect]}, 9.0) == 5.0
    both = {**effect, "one_of": {"members": [{"port": p, "mechanism": m} for p, m in (lag, delay)]}}
    assert stood_from(heard, {"effects": [both]}, 9.0) == 3.0, "what it cannot be told from leads as well"
    assert stood_from([], {"effects": [effect]}, 9.0) == stood_from(heard, {"effects": []}, 9.0) == 9.0


def test_the_share_of_cases_that_lead_in_time_counts_what_failed() -> None:
    details = {"one": [{"leading": 3.0}], "two": [{"leading": 11.0}], "three": [None], "four": [{"leading": 10.0}]}
    assert _leading(details).measured == 50.0 and not _leading(details).met


def test_the_installed_tree_does_not_stand_in_for_another(monkeypatch) -> None:
    installed = type("Finder", (), {"__module__": "__editable___greybox_torch_0_1_0_finder"})
    kept = [f for f in sys.meta_path if not getattr(f, "__module__", "").startswith("__editable__")]
    monkeypatch.setattr(sys, "meta_path", [*kept, installed])
    leave_out_installed()
    assert sys.meta_path == kept and kept


def test_the_demo_is_always_there_and_an_unknown_commit_is_said() -> None:
    assert cases()[DEMO].exists()
    with pytest.raises(ValueError, match="--against nowhere"), checked_out("nowhere"):
        pass
