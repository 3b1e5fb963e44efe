"""Refits on windows, from several starts."""

from __future__ import annotations

from typing import Any

from greybox_torch.diagnosis.hypothesis import continued as continued_module
from greybox_torch.diagnosis.hypothesis import fit as fit_module
from greybox_torch.diagnosis.hypothesis import noise as noise_module
from greybox_torch.diagnosis.hypothesis.fit import hypothesis
from greybox_torch.estimate.window_fit import fit_windows
from greybox_torch.simulation.simulator import DEFAULT


class Never:
    """Holds no parameters for admissible."""

    def __get__(self, problem: Any, kind: Any) -> Any:
        return lambda values: False


def test_there_is_no_hypothesis_where_no_start_is_admissible(dead_zone_search, monkeypatch) -> None:
    problem = dead_zone_search.study.problem
    monkeypatch.setattr(type(problem), "admissible", Never())
    assert hypothesis(problem, (), {}, [dead_zone_search.study.card], options=DEFAULT) is None


def test_a_fit_that_is_carried_on_is_not_begun_anew(dead_zone_search, monkeypatch) -> None:
    """Nor lost where nothing else can be simulated."""
    study, plain = dead_zone_search.study, dead_zone_search.plain
    for module in (fit_module, continued_module):
        monkeypatch.setattr(module, "fit_windows", lambda *_, **__: None)
    again = hypothesis(study.problem, (), {}, [plain.values()], options=study.options, before=plain)
    assert again is not None
    assert again.fits == plain.fits
    assert hypothesis(study.problem, (), {}, [plain.values()], options=study.options) is None


def test_no_other_start_is_tried_where_the_noise_is_reached(dead_zone_search, monkeypatch) -> None:
    study, plain, begun = dead_zone_search.study, dead_zone_search.plain, []

    def counted(*fixed: Any, settings: Any, **how: Any) -> Any:
        begun.append(settings == study.budget.first_iterations)
        return fit_windows(*fixed, settings=settings, **how)

    monkeypatch.setattr(fit_module, "fit_windows", counted)
    starts = [plain.values(), {n: 1.1 * v for n, v in plain.values().items()}]
    for noise, tried in ((0.0, 2), (1e9, 1)):
        begun.clear()
        monkeypatch.setattr(noise_module, "noise_floor", lambda *_, floor=noise: floor)
        hypothesis(study.problem, (), {}, starts, options=study.options, at=[40])
        assert sum(begun) == tried


def test_a_hypothesis_does_not_keep_the_passes_that_its_fits_ended_with(dead_zone_search) -> None:
    """Seen: matrices of every window of every length, for every hypothesis of a search."""
    study, plain = dead_zone_search.study, dead_zone_search.plain
    again = hypothesis(study.problem, (), {}, [study.card], options=study.options, at=[40])
    assert again is not None and again.fits[0].ended is None
    assert all(fit.ended is None for fit in plain.fits)
