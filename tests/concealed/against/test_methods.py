"""Every method on a case that it can solve, and on one in which nothing is missing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from experiments.concealed.against import methods
from experiments.concealed.against.methods import BASELINES, METHODS, results
from experiments.concealed.against.neural_residual import neural_residual
from experiments.concealed.against.plain import Plain
from experiments.verdicts.scoring import score
from greybox_torch.errors import NumericalError

KEY: dict[str, Any] = {
    "effects": ["quadratic_drag"],
    "accept": [[["rotor", "quadratic_drag"]]],
    "near": [[]],
    "ports": [["rotor"]],
    "sigma": 0.01,
}


def test_the_sparse_regression_names_the_drag_and_closes_the_error(tuned: Callable[[str], Plain]) -> None:
    pytest.importorskip("pysindy", reason="pysindy is not installed (extra [proof])")
    found = results(tuned("drag"), "sindy")
    scored = {name: score("drag", result, KEY) for name, result in found.items()}
    assert [f.mechanism for f in scored["sindy_refitted"].findings if f.right] == ["quadratic_drag"]
    assert scored["sindy_refitted"].closed is not None
    assert scored["sindy_refitted"].closed > 0.9
    assert all(row["role"] == "validation" for row in found["sindy"]["fit"])


def test_the_sparse_regression_says_nothing_where_nothing_is_missing(tuned: Callable[[str], Plain]) -> None:
    pytest.importorskip("pysindy", reason="pysindy is not installed (extra [proof])")
    for result in results(tuned("plain"), "sindy").values():
        assert result["effects"] == []
        assert not result["mismatch"]
        assert all(row["augmented"] == row["refit"] for row in result["fit"])


def test_the_network_closes_the_error_and_cannot_name_it(tuned: Callable[[str], Plain]) -> None:
    plain = tuned("drag")
    answer = neural_residual(plain, widths=(4,))
    result = methods.result(plain, "network", answer, 1.0)
    assert (result["can_name"], result["effects"]) == (False, [])
    closed = score("drag", result, KEY).closed
    assert closed is not None
    assert closed > 0.5


def test_the_retuned_model_closes_nothing_of_what_it_leaves(tuned: Callable[[str], Plain]) -> None:
    result = results(tuned("drag"), "retuned")["retuned"]
    assert score("drag", result, KEY).closed == 0.0
    assert all(row["refit"]["rmse"] < row["start"]["rmse"] for row in result["fit"])


def test_numbers_that_fail_are_a_result_that_says_so(
    tuned: Callable[[str], Plain], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(plain: Plain) -> Any:
        raise NumericalError("the model overflows")

    monkeypatch.setitem(METHODS, "network", (("network",), fails))
    assert results(tuned("plain"), "network")["network"]["failed"] == "the model overflows"


def test_every_baseline_has_a_name_in_the_table() -> None:
    from experiments.concealed.against.table import METHODS as TITLES

    assert set(BASELINES) < set(TITLES)
