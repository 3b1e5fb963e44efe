"""Refits on windows, from several starts."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis import fit as fit_module
from greybox_torch.diagnosis.hypothesis.fit import hypothesis, window_lengths
from greybox_torch.simulation.simulator import DEFAULT


class Never:
    """Holds no parameters for admissible."""

    def __get__(self, problem: Any, kind: Any) -> Any:
        return lambda values: False


def test_there_is_no_hypothesis_where_no_start_is_admissible(dead_zone_search, monkeypatch) -> None:
    problem = dead_zone_search.study.problem
    monkeypatch.setattr(type(problem), "admissible", Never())
    assert hypothesis(problem, (), {}, [dead_zone_search.study.card], options=DEFAULT) is None


@pytest.mark.parametrize(
    ("records", "lengths"),
    [
        ([19838], [310, 1240, 2479]),  # four windows of 4960 would be too few
        ([6000, 6000], [94, 376, 1504]),
        ([110, 110], [20]),
        ([30], [20]),
    ],
)
def test_there_are_at_least_eight_windows_of_the_longest(records: list[int], lengths: list[int]) -> None:
    problem: Any = SimpleNamespace(records=SimpleNamespace(lengths=np.array(records)))
    assert window_lengths(problem) == lengths


def test_a_fit_that_is_carried_on_is_not_begun_anew(dead_zone_search, monkeypatch) -> None:
    """Nor lost where nothing else can be simulated."""
    study, plain = dead_zone_search.study, dead_zone_search.plain
    monkeypatch.setattr(fit_module, "fit_windows", lambda *_, **__: None)
    again = hypothesis(study.problem, (), {}, [plain.values()], options=study.options, before=plain)
    assert again is not None
    assert again.fits == plain.fits
    assert hypothesis(study.problem, (), {}, [plain.values()], options=study.options) is None
