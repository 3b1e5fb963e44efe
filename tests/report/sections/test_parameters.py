from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from greybox_torch.diagnosis.own_parameters import Estimate
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.about import About
from greybox_torch.report.page import render_page
from greybox_torch.report.sections.parameters import Parameters

F_C = Estimate("F_c", "N m", 0.6, (0.83, 0.02), (0.5983, 0.0011))
K = Estimate("k_g1", "N m/rad", 20.0, (19.0, None), (20.31, 0.25))


def test_before_and_after(of_kind: Callable[[str], Verdict], about: About) -> None:
    verdict = replace(of_kind("found"), parameters=(F_C, K))
    told = Parameters.of(verdict)
    assert told is not None and [name for name, _ in told.columns] == ["Start", "Refit", "Augmented"]
    assert [row.values for row in told.rows] == [
        ("0.6000", "0.830 ± 0.020", "0.5983 ± 0.0011"),
        ("20.00", "19.00", "20.31 ± 0.25"),
    ]
    assert '<section id="parameters">' in render_page(verdict, about)


def test_deviations_above_their_values_are_commented(of_kind: Callable[[str], Verdict], about: About) -> None:
    vague = replace(K, refit=(0.4, 4.1))
    for parameters, commented in (((F_C, K), False), ((F_C, vague), True)):
        page = render_page(replace(of_kind("found"), parameters=parameters), about)
        assert ("Where the standard deviation exceeds the value" in page) == commented


def test_nothing_missing(of_kind: Callable[[str], Verdict]) -> None:
    told = Parameters.of(replace(of_kind("nothing"), parameters=(replace(F_C, augmented=None),)))
    assert told is not None and told.rows[0].values == ("0.6000", "0.830 ± 0.020") and len(told.columns) == 2


def test_a_model_without_free_parameters(of_kind: Callable[[str], Verdict]) -> None:
    assert Parameters.of(of_kind("found")) is None


def test_a_parameter_at_a_bound_is_told_below_the_table(of_kind) -> None:
    bounded = replace(of_kind("found"), parameters=(replace(F_C, at_bound=(False, True)), K))
    told = Parameters.of(bounded)
    assert told is not None and told.bounded.startswith("At a bound: F_c = 0.5983 N m (with the effects);")
