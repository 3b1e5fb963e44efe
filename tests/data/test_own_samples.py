"""The samples that a slower sensor took, and which of them are missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.data import Recording
from greybox_torch.data.own_samples import missing_samples, own_samples, own_step
from greybox_torch.report.channels import plot_channels

NAN = np.nan


@pytest.fixture
def slower() -> Recording:
    """Twenty samples 0.1 s apart; every third is y's own. There is none before sample 3 and behind 15; that at 9 is missing, and with it
    the straight lines beside it.
    """
    y = np.array([NAN] * 3 + [1.0, 1.1, 1.2, 1.3] + [NAN] * 5 + [2.0, 2.1, 2.2, 2.3] + [NAN] * 4)
    u = np.where(np.isin(np.arange(20), (0, 7, 19)), NAN, 5.0)
    run = Recording.from_arrays("run", {"u": u, "y": y}, sample_time=0.1)
    return replace(run, between={"y": np.arange(20) % 3 != 0})


def test_what_is_missing_of_a_slower_sensor_is_one_of_its_own_samples(slower: Recording) -> None:
    assert np.flatnonzero(own_samples(slower, "y")).tolist() == [0, 3, 6, 9, 12, 15, 18]
    assert own_step(slower, "y") == pytest.approx(0.3)
    assert np.flatnonzero(missing_samples(slower, "y")).tolist() == [9]
    assert np.isnan(slower.signals["y"]).sum() == 12, "the recording itself is left as it is"


def test_of_any_other_channel_all_that_is_missing_counts(slower: Recording) -> None:
    """Also before the first sample and behind the last."""
    assert own_samples(slower, "u").all() and own_step(slower, "u") == pytest.approx(0.1)
    assert np.flatnonzero(missing_samples(slower, "u")).tolist() == [0, 7, 19]


def test_inspect_and_its_figure_count_them_alike(slower: Recording) -> None:
    """Seen: "12 missing" and as many red marks, of a sensor that lacks one sample."""
    data = gt.DataSet([slower], held_out_by_default=False)
    rows = {row["channel"]: row for row in gt.inspect(data).rows}
    assert [(rows[name]["samples"], rows[name]["missing"]) for name in ("u", "y")] == [(20, 3), (7, 1)]
    axes = plot_channels(data).axes[1]
    marks = [line for line in axes.lines if line.get_color() == "tab:red"]
    assert [np.round(np.asarray(line.get_xdata()), 6).tolist() for line in marks] == [[0.9]]
    assert [text.get_text() for text in axes.texts] == ["1 missing"]
