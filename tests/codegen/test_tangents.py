"""Which entries of a step's matrices are zero, and tangents of chains, in which most of them are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.codegen.tangents import STAGES, WRITTEN_OUT, Entry, Transition
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.windows import whole_records
from tests.simulation.arm import native


@st.composite
def sparse(draw: st.DrawFn) -> tuple[int, frozenset[tuple[int, int]]]:
    size = draw(st.integers(1, 7))
    places = st.tuples(st.integers(0, size - 1), st.integers(0, size - 1))
    return size, draw(st.frozensets(places, max_size=2 * size))


@given(sparse(), st.integers(0, 2**32 - 1))
def test_entries_are_zero_where_the_jacobian_makes_them(
    drawn: tuple[int, frozenset[tuple[int, int]]], seed: int
) -> None:
    """The matrices of a Runge-Kutta step with positive numbers at those places, in which nothing cancels."""
    size, places = drawn
    rng = np.random.default_rng(seed)
    stages = np.zeros((STAGES, size, size))
    for i, j in places:
        stages[:, i, j] = rng.uniform(0.5, 2.0, STAGES)
    through, step = [np.eye(size) / 6], np.eye(size)
    for stage, factor, weight in ((3, 1.0, 1 / 3), (2, 0.5, 1 / 3), (1, 0.5, 1 / 6), (0, 0.0, 0.0)):
        product = through[0] @ stages[stage]
        step = step + product
        through.insert(0, factor * product + weight * np.eye(size))
    found = Transition.of(size, {place: Entry(k, None) for k, place in enumerate(sorted(places))})
    for matrix, expected in zip((*found.through, found.step), (*through[1:], step), strict=True):
        assert matrix == {(int(i), int(j)) for i, j in np.argwhere(expected)}


class Chain(GreyBoxModel):
    """First-order lags one behind another, the first of them loaded by a saturating one, and the travel between the first and the last, by
    which the Jacobian has entries of 1 and -1.
    """

    inputs = (Input("u", "V"),)
    outputs = (Output("last", "V"),)
    parameters = (Parameter("T", 0.05, "s"), Parameter("a", 0.7))

    def __init__(self, length: int) -> None:
        self.states = (*(State(f"x{k}", "V") for k in range(length)), State("travel", "V s"))
        super().__init__()

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        values = [getattr(x, state.name) for state in self.states[:-1]]
        rates = {"x0": (u.u - values[0] - p.a * (values[1].tanh() if len(values) > 1 else 0.0)) / p.T}
        rates |= {f"x{k}": (values[k - 1] - values[k]) / p.T for k in range(1, len(values))}
        return rates | {"travel": values[0] - values[-1] if len(values) > 1 else values[0]}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"last": getattr(x, self.states[-2].name) + 0.1 * x.travel}


@pytest.mark.parametrize("length", [1, 2, 5, WRITTEN_OUT - 1, WRITTEN_OUT])
def test_tangents_of_a_chain(length: int) -> None:
    """Those that are written out, and those in loops, as torch has them."""
    model, names, n = Chain(length), ("T", "a"), 60
    rng = np.random.default_rng(length)
    records = Records(
        rng.normal(size=(1, n)), np.zeros((1, n)), np.full(n, 0.02), np.array([0]), np.array([n - 1]), ("",), "zoh"
    )
    asked = Pass(
        whole_records(records),
        np.array([0.05, 0.7]),
        rng.normal(size=(1, length + 1)),
        tangents=True,
        start_directions=np.eye(length + 1)[None],
    )
    one, other = (
        native(model, names).run(records, asked),
        EagerStepper.of(model, names, "cpu", "double").run(records, asked),
    )
    assert other.dy is not None and other.dx_end is not None
    for part in ("y", "dy", "x_end", "dx_end"):
        expected = getattr(other, part)
        np.testing.assert_allclose(getattr(one, part), expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max())
    assert np.abs(other.dx_end).max() > 0
