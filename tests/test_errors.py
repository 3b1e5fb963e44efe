from __future__ import annotations

import pytest

from greybox_torch.errors import GreyboxError, NumericalError, UserError, did_you_mean


@pytest.mark.parametrize("kind", [UserError, NumericalError])
def test_text_of_an_error_is_its_message(kind: type[GreyboxError]) -> None:
    assert str(kind("field: found 1, expected 2")) == "field: found 1, expected 2"
    assert issubclass(kind, GreyboxError)


@pytest.mark.parametrize(
    ("name", "known", "hint"),
    [
        ("torqe", ["speed", "torque"], ' (did you mean "torque"?)'),
        ("u", ["U", "Y"], ' (did you mean "U"?)'),
        ("voltage", ["speed"], ""),
        ("voltage", [], ""),
    ],
)
def test_did_you_mean(name: str, known: list[str], hint: str) -> None:
    assert did_you_mean(name, known) == hint
