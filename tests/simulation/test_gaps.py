"""Over a gap in the time stamps the stepper makes as many steps as elsewhere in as long a time; without one it makes those of ever."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.parts_of_gaps import MOST, parts_of_gaps
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.windows import Windows, whole_records
from tests.simulation.arm import ARM, PARAMETERS, X0, P, arm_records, native
from tests.simulation.test_stepper import arm_rates, scipy_states

GAP = 130


def with_gap(hold: str, times: float = 60.0):
    """Records of two experiments, the first of which has a gap."""
    records = arm_records((200, 60), hold)
    dt = records.dt.copy()
    dt[GAP] *= times
    return replace(records, dt=dt)


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_against_scipy(hold: str) -> None:
    """Seen: a motor's current of 770 A behind a gap of 0.3 s, as the step over it was as long."""
    records = with_gap(hold)
    expected = scipy_states(records, arm_rates, X0)
    first = Windows(records.first[:1], records.last[:1], 200)
    found = native().run(records, Pass(first, P, X0[None], keep_states=True)).states
    assert found is not None
    size = np.abs(expected).max(axis=0)
    assert (np.abs(found[0] - expected) < 1e-3 * size).all()


def test_compiled_and_eager_agree() -> None:
    records = with_gap("foh", 12.0)
    asked = Pass(Windows(np.array([0, 120, 200]), np.array([99, 199, 259]), 30), P, np.tile(X0, (3, 1)), tangents=True)
    one = native().run(records, asked, substeps=2)
    other = EagerStepper.of(ARM, PARAMETERS, "cpu", "double").run(records, asked, substeps=2)
    assert one.dy is not None and other.dy is not None
    np.testing.assert_allclose(one.y, other.y, rtol=1e-10, atol=1e-10 * np.abs(other.y).max())
    np.testing.assert_allclose(one.dy, other.dy, rtol=1e-9, atol=1e-9 * np.abs(other.dy).max())


def test_parts() -> None:
    records = with_gap("zoh", 59.3)
    parts = parts_of_gaps(records)
    assert parts is not None and parts[GAP] == 60 and (np.delete(parts, GAP) == 1).all()
    far = parts_of_gaps(with_gap("zoh", 1e6))
    assert far is not None and far.max() == MOST
    assert parts_of_gaps(arm_records((200, 60), "zoh")) is None
    assert parts_of_gaps(with_gap("zoh", 3.0)) is None, "a few lost samples are no gap"


def test_windows_that_meet_no_gap_are_as_they_were_but_for_rounding() -> None:
    """In one group of lanes with one that does they are made in finer steps."""
    plain, gapped = arm_records((200, 60), "zoh"), with_gap("zoh")
    before = native().run(plain, Pass(whole_records(plain), P, np.tile(X0, (2, 1))))
    after = native().run(gapped, Pass(whole_records(gapped), P, np.tile(X0, (2, 1))))
    np.testing.assert_array_equal(before.y[0, :GAP], after.y[0, :GAP])
    np.testing.assert_allclose(before.y[1, :60], after.y[1, :60], rtol=1e-3)
