"""Windows side by side: cut from experiments, continued, and independent of their neighbours."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.windows import Windows, cut, whole_records
from tests.simulation.arm import X0, P, arm_records, native


def test_windows_are_pieces_of_one_run() -> None:
    records = arm_records((150,))
    whole = native().run(records, Pass(whole_records(records), P, X0[None], tangents=True, keep_states=True))
    assert whole.states is not None
    starts = np.array([0, 1, 17, 64, 100])
    windows = Windows(starts, np.full(5, 149), 50)
    pieces = native().run(records, Pass(windows, P, whole.states[0, starts], keep_states=True))
    assert pieces.states is not None
    for piece, start in zip(range(5), starts, strict=True):
        np.testing.assert_allclose(pieces.y[piece], whole.y[0, start : start + 50], rtol=1e-12)
        np.testing.assert_allclose(pieces.states[piece], whole.states[0, start : start + 50], rtol=1e-12, atol=1e-15)


def test_a_record_continued_in_chunks() -> None:
    """The end of a chunk, with its tangents, is where the next begins."""
    records = arm_records((120,))
    whole = native().run(records, Pass(whole_records(records), P, X0[None], tangents=True))
    first = native().run(records, Pass(Windows(np.array([0]), np.array([119]), 70), P, X0[None], tangents=True))
    rest = native().run(
        records,
        Pass(Windows(np.array([70]), np.array([119]), 50), P, first.x_end, tangents=True, tangents0=first.dx_end),
    )
    for part in ("y", "dy"):
        joined = np.concatenate([getattr(first, part), getattr(rest, part)], axis=1)
        np.testing.assert_allclose(joined, getattr(whole, part), rtol=1e-12, atol=1e-12)


def test_experiments_of_unequal_length() -> None:
    """Side by side they give what each gives alone, whatever stands next to it on the records."""
    lengths = (90, 11, 47)
    records = arm_records(lengths)
    x0 = X0 * np.array([[1.0], [0.5], [-1.0]])
    together = native().run(records, Pass(whole_records(records), P, x0, tangents=True))
    for e, n in enumerate(lengths):
        part = records.span(e)
        alone = Records(
            records.u[:, part], records.y[:, part], records.dt[part], np.array([0]), np.array([n - 1]), ("",), "zoh"
        )
        run = native().run(alone, Pass(whole_records(alone), P, x0[e : e + 1], tangents=True))
        assert run.dy is not None
        assert together.dy is not None
        np.testing.assert_array_equal(together.y[e, :n], run.y[0])
        np.testing.assert_array_equal(together.dy[e, :n], run.dy[0])


def test_more_windows_than_lanes() -> None:
    """Windows beyond a vector's width, each with parameters of its own, do not mix."""
    records = arm_records((60,))
    count = 19
    p = P * np.linspace(0.9, 1.1, count)[:, None]
    together = native().run(
        records, Pass(Windows(np.zeros(count, int), np.full(count, 59), 60), p, np.tile(X0, (count, 1)))
    )
    for w in (0, 7, 8, 18):
        alone = native().run(records, Pass(whole_records(records), p[w], X0[None]))
        np.testing.assert_array_equal(together.y[w], alone.y[0])


@pytest.mark.parametrize(
    ("lengths", "length"), [((100,), 30), ((100, 64), 32), ((10,), 30), ((95, 7), 10), ((101,), 1), ((45,), 30)]
)
def test_cut(lengths: tuple[int, ...], length: int) -> None:
    """Every sample is in one window, no window crosses experiments, and all are about as long as they should be."""
    records = arm_records(lengths)
    windows = cut(records, length)
    sizes = windows.last - windows.start + 1
    experiment = np.searchsorted(records.first, windows.start, side="right") - 1
    assert (windows.last <= records.last[experiment]).all()
    samples = [np.arange(a, b + 1) for a, b in zip(windows.start, windows.last, strict=True)]
    assert np.concatenate(samples).tolist() == list(range(sum(lengths)))
    assert windows.steps == sizes.max() <= 1.5 * length
    assert (sizes >= np.minimum(length / 2, np.array(lengths)[experiment])).all()
