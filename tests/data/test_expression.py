from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.data.expression import parse_expression, turns_of

COLUMNS = {
    "a": np.array([1.0, 2.0, np.nan]),
    "b": np.array([3.0, -4.0, 5.0]),
    "log.motor.u": np.ones(3),
    "v x": np.full(3, 2.0),
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.5 * (a - b)", [-1.0, 3.0, np.nan]),
        ("-a ** 2 + 1", [0.0, -3.0, np.nan]),
        ("log.motor.u + 0 * b", [1.0, 1.0, 1.0]),
        ('hypot(col("v x"), 0 * b) * pi / pi', [2.0, 2.0, 2.0]),
        ("maximum(b, 0)", [3.0, 0.0, 5.0]),
        ("radians(b) / radians(1)", [3.0, -4.0, 5.0]),
        (" abs(b)", [3.0, 4.0, 5.0]),
    ],
)
def test_values(text: str, expected: list[float]) -> None:
    np.testing.assert_allclose(parse_expression(text).of(COLUMNS), expected)


def test_columns_that_it_needs() -> None:
    assert parse_expression('a * col("Y[:, 1]") + a * log.motor.u - pi').columns == ("a", "Y[:, 1]", "log.motor.u")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "1 + 2",
        "a +",
        "__import__('os').system('true')",
        "a.__class__.__mro__[0]",
        "open('x')",
        "[a for a in b]",
        "lambda: a",
        "a if a else b",
        "a == b",
        "a @ b",
        "a // b",
        "a << 3",
        "'a'",
        "True * a",
        "1j * a",
        "f'{a}'",
        "sin(a, b)",
        "sin(x=a)",
        "hypot(a)",
        "col(a)",
        "col('a', 'b')",
        "a[0]",
        "(a := b)",
        "a, b",
        "eval('a')",
        "a\0",
        "(" * 250 + "a" + ")" * 250,
        "9" * 490 + "* a",
        "a" * 501,
        "9**9**9 if a else 1",
    ],
)
def test_what_is_not_understood(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        parse_expression(text)


def test_a_tower_of_powers_is_no_work() -> None:
    assert np.isinf(parse_expression("0 * b + 9**9**9**9**9").of(COLUMNS)).all()


@given(st.text(alphabet="ab().+-*/ 0123456789,'\"[]=:_sincol\n\\\0", max_size=40))
def test_any_text_is_an_expression_or_a_value_error(text: str) -> None:
    try:
        found = parse_expression(text)
    except ValueError:
        return
    assert found.of({column: np.ones(3) for column in found.columns}).shape == (3,)


@given(
    st.lists(st.floats(-0.49, 0.49), min_size=1, max_size=60),
    st.sampled_from([1.0, 360.0, 2.0 * np.pi, 16384.0]),
    st.sets(st.integers(0, 60)),
    st.floats(-3.0, 3.0),
)
def test_unwrapping_undoes_a_counter_that_begins_anew(
    steps: list[float], period: float, missing: set[int], begin: float
) -> None:
    turned = period * (begin + np.concatenate([[0.0], np.cumsum(steps)]))
    wrapped = np.mod(turned, period)
    gone = np.array(sorted(k for k in missing if k < len(turned)), dtype=int)
    found = parse_expression(f"unwrap(a, {period!r})").of({"a": wrapped})
    np.testing.assert_allclose(found - turned, wrapped[0] - turned[0], atol=1e-6 * period)
    wrapped[gone] = np.nan
    again = parse_expression(f"unwrap(a, {period!r})").of({"a": wrapped})
    assert np.array_equal(np.isnan(again), np.isnan(wrapped))
    known = again[~np.isnan(again)]
    assert np.all(np.abs(np.diff(known)) <= 0.5 * period * (1 + 1e-9))
    np.testing.assert_allclose(np.mod(known - wrapped[~np.isnan(wrapped)] + 0.5 * period, period), 0.5 * period)


@pytest.mark.parametrize(
    "text", ["unwrap(a)", "unwrap(a, b)", "unwrap(a, 0)", "unwrap(a, -1)", "unwrap(a, 1/0)", "unwrap(a, 9**9**9)"]
)
def test_a_period_is_a_number_above_zero(text: str) -> None:
    with pytest.raises(ValueError, match="unwrap"):
        parse_expression(text)


@pytest.mark.parametrize(
    ("text", "turns"),
    [
        ("unwrap(q, 4096)", {"q": 4096.0}),
        ("unwrap(radians(q), 2 * pi) - 0.3", {"q": 360.0}),
        ("unwrap(unwrap(q, 360) * pi / 180, 2 * pi)", {"q": 360.0}),
        ('unwrap(1 - 2 * col("q a"), 8) + unwrap(r, 1)', {"q a": 4.0, "r": 1.0}),
        ("unwrap(q, 360) + q", {}),
        ("unwrap(q + r, 360)", {}),
        ("unwrap(sin(q), 1)", {}),
        ("q", {}),
    ],
)
def test_columns_of_which_nothing_but_the_added_turns_is_needed(text: str, turns: dict[str, float]) -> None:
    assert parse_expression(text).turns == pytest.approx(turns)


def test_a_column_that_another_channel_needs_as_it_is_keeps_its_jumps() -> None:
    needed = [parse_expression(text) for text in ("unwrap(q, 360)", "unwrap(r, 360)", "sin(q)", "unwrap(r, 360) / 2")]
    assert turns_of(needed) == {"r": 360.0}
    assert turns_of([parse_expression("unwrap(r, 360)"), parse_expression("unwrap(r, 180)")]) == {}
