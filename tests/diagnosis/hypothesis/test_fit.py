"""Refits on windows, from several starts."""

from __future__ import annotations

from typing import Any

from greybox_torch.diagnosis.hypothesis import fit as fit_module
from greybox_torch.diagnosis.hypothesis.fit import hypothesis
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
    monkeypatch.setattr(fit_module, "fit_windows", lambda *_, **__: None)
    again = hypothesis(study.problem, (), {}, [plain.values()], options=study.options, before=plain)
    assert again is not None
    assert again.fits == plain.fits
    assert hypothesis(study.problem, (), {}, [plain.values()], options=study.options) is None
