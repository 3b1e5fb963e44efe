"""Settings and budgets reach the search, from Python, from the card and from a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from typer.testing import CliRunner

from greybox_torch.cli import app
from greybox_torch.commands import diagnose as command
from greybox_torch.diagnosis.confirm import simpler_laws
from greybox_torch.diagnosis.select import explore
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.stopping import result_of


def refits(found: Any, **fields: Any) -> tuple[int, int]:
    """How many refits a search reports with some fields of settings or budget, and how many effects it finds."""
    told: list[str] = []
    budget = {n: v for n, v in fields.items() if hasattr(found.study.budget, n)}
    settings = {n: v for n, v in fields.items() if n not in budget}
    study = replace(
        found.study,
        report=told.append,
        settings=replace(found.study.settings, **settings),
        budget=replace(found.study.budget, **budget),
    )
    state = result_of(search(study, found.state))
    return sum(text.startswith("refitting") for text in told), len(state.effects)


def test_a_budget_changes_the_number_of_refits_and_a_setting_the_outcome(dead_zone_search) -> None:
    many, effects = refits(dead_zone_search)
    assert effects == 1
    few, _ = refits(dead_zone_search, named_per_length=1, curves_per_length=0, most_screen_ties=1, finalists=1)
    assert 0 < few < many
    unsure = {"least_significance": 1e9, "least_likelihood_significance": 1e9, "least_significance_of_doubtful": 1e9}
    assert refits(dead_zone_search, **unsure)[1] == 0


def run(card: Path, monkeypatch, *more: str) -> tuple[Any, Any]:
    """What the command gives to the search, and how it ends."""
    given: dict[str, Any] = {}

    def diagnose(*_: Any, **keywords: Any) -> None:
        given.update(keywords)
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "diagnose", diagnose)
    ended = CliRunner().invoke(app, ["diagnose", str(card), *more])
    return SimpleNamespace(**given), ended


def test_a_file_goes_before_the_card_and_the_card_before_the_defaults(motor_folder, tmp_path, monkeypatch) -> None:
    card = motor_folder() / "dataset.toml"
    card.write_text(card.read_text() + "\n[diagnosis]\nleast_gain = 0.02\nfinalists = 2\n")
    own = tmp_path / "own.toml"
    own.write_text("least_gain = 0.04\n")
    given, _ = run(card, monkeypatch, "--settings", str(own))
    assert given.settings == DiagnosisSettings(least_gain=0.04) and given.budget == SearchBudget(finalists=2)
    own.write_text("least_gian = 0.04\n")
    _, ended = run(card, monkeypatch, "--settings", str(own))
    assert ended.exit_code == 2
    assert str(own) in ended.stderr.replace("\n", "") and '"least_gian" is not a setting' in ended.stderr
    card.write_text(card.read_text().replace("finalists = 2", "finalists = 0"))
    _, ended = run(card, monkeypatch)
    assert ended.exit_code == 2 and "[diagnosis]: finalists: found 0" in ended.stderr


def test_what_a_rejected_way_found_instead_of_its_curve_is_not_kept(dead_zone_search, monkeypatch) -> None:
    start = dead_zone_search.state
    first = replace(start, steps=(*start.steps, SimpleNamespace()), named=None)
    other = replace(first, named=start)

    def taken(*_: Any) -> Any:
        yield first
        return first

    passed = SimpleNamespace(attachment=SimpleNamespace(prefix="rotor.something"))
    monkeypatch.setattr(explore, "take_effects", taken)
    monkeypatch.setattr(explore, "passed_over", lambda *_: passed)
    monkeypatch.setattr(explore, "_from_given", lambda *_: (other, False))
    assert result_of(explore.explore(dead_zone_search.study, start)).named is None


def test_where_nothing_is_left_no_other_way_is_gone(dead_zone_search, monkeypatch) -> None:
    study, start = dead_zone_search.study, dead_zone_search.state
    effect = SimpleNamespace(prefix="rotor.something")
    asked: list[bool] = []
    monkeypatch.setattr(explore, "passed_over", lambda *_: asked.append(True))
    for noise in (1.0, 0.0):
        fits = tuple(replace(f, mean_square=noise * f.mean_square) for f in start.plain.fits)
        found = replace(start, steps=(SimpleNamespace(),), current=replace(start.plain, effects=(effect,), fits=fits))

        def taken(*_: Any, found: Any = found) -> Any:
            yield found
            return found

        monkeypatch.setattr(explore, "take_effects", taken)
        assert result_of(explore.explore(study, start)) is found
    assert asked == [True]


def test_effects_that_pruning_dropped_are_not_asked_for_simpler_laws(monkeypatch) -> None:
    one, two = SimpleNamespace(prefix="a.x"), SimpleNamespace(prefix="a.y")
    pruned = SimpleNamespace(effects=(), prefixes=())
    state = SimpleNamespace(effects=(one, two), prefixes=("a.x", "a.y"), current=None)
    asked: list[str] = []

    def contained(study: Any, state: Any, effect: Any) -> list[Any]:
        asked.append(effect.prefix)
        return [(None, None)]

    def dropped(*_: Any) -> Any:
        yield pruned
        return pruned

    monkeypatch.setattr(simpler_laws, "_contained", contained)
    monkeypatch.setattr(simpler_laws, "side_by_side", lambda _: ((), ()))
    monkeypatch.setattr(simpler_laws, "likelihood_significance", lambda *_: 0.0)
    monkeypatch.setattr(simpler_laws, "_with_rival", lambda state, *_: state)
    monkeypatch.setattr(simpler_laws, "drop_superfluous", dropped)
    study: Any = SimpleNamespace(settings=DiagnosisSettings())
    others: Any = SimpleNamespace(fits=None)
    given: Any = state
    assert result_of(simpler_laws.with_simpler_laws(study, given, others)) is pruned
    assert asked == ["a.x"]
