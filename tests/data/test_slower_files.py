"""What a slower logger measured counts where it was measured, not between."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.data.processing import between_samples
from greybox_torch.diagnosis.hypothesis.noise import floor_known, noise_floor, output_floors
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import make_problem
from greybox_torch.simulation.records import make_records

CARD = """time = "t"
[channels]
u = { column = "u", unit = "N" }
y = { column = "y", unit = "m/s" }
[[experiment]]
name = "a"
file = ["fast.csv", "slow.csv"]
join = "time"
"""
N, STEP, SLOW, NOISE = 900, 0.1, 0.3, 0.02


class Cart(GreyBoxModel):
    states = [State("y", "m/s")]
    inputs = [Input("u", "N")]
    outputs = [Output("y", "m/s")]
    parameters = [Parameter("m", 1.0, unit="kg", lower=0.01)]
    ports = [Body("cart", speed="y")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"y": (u.u - x.y + port.cart) / p.m}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"y": x.y}


def _joined(folder: Path, slow: float) -> DataSet:
    rng, t = np.random.default_rng(2), STEP * np.arange(N)
    u = np.sin(0.05 * t) + 0.2
    at = np.arange(0.04, t[-1], slow)
    seen = np.interp(at, t, u) + rng.normal(0.0, NOISE, len(at))
    np.savetxt(folder / "fast.csv", np.column_stack([t, u]), header="t,u", delimiter=",", comments="")
    np.savetxt(folder / "slow.csv", np.column_stack([at, seen]), header="t,y", delimiter=",", comments="")
    (folder / "dataset.toml").write_text(CARD)
    return load_dataset(folder / "dataset.toml")


def test_the_nearest_samples_count(tmp_path: Path) -> None:
    times, stamps = np.arange(10.0), np.array([0.4, 3.6, 6.4, 9.5])
    between = between_samples(times, stamps)
    assert between is not None and list(np.flatnonzero(~between)) == [0, 4, 6], "9.5 lies beyond the last"
    assert between_samples(times, times + 0.3) is None and between_samples(times, np.arange(0.0, 9.0, 0.5)) is None


def test_an_output_counts_at_its_own_samples_and_an_input_everywhere(tmp_path: Path) -> None:
    """Seen: a product's temperature every 30 s beside a controller's log every 10 s: of a complete model 4.9 times the noise were left,
    "look for what is not recorded, such as a load"; 1.2 times where its own samples count alone."""
    data = _joined(tmp_path, SLOW)
    first, held_out = data.recordings
    counted = ~np.isnan(np.concatenate([first.measured("y"), held_out.measured("y")]))
    assert counted.sum() == 299 and not np.isnan(first.signals["y"][1:]).any()
    assert first.notes[-1] == "slower than the rest, an output among them counts at its own samples alone: y"
    records = make_records(data, Cart(), data.recordings)
    np.testing.assert_array_equal(np.isnan(records.y[0]), ~counted)
    assert not np.isnan(records.u).any()
    (variance,) = output_floors(make_problem(data, Cart(), [first]), DiagnosisSettings())[0]
    assert (0.8 * NOISE) ** 2 < variance < (1.2 * NOISE) ** 2
    problem = make_problem(data, Cart(), [first])
    over_all = noise_floor(problem, DiagnosisSettings()) / problem.weights[0] ** 2
    assert over_all == pytest.approx(variance) and floor_known(problem, DiagnosisSettings(noise_floors_agree=1.2))


def test_of_a_file_as_fast_every_sample_counts(tmp_path: Path) -> None:
    (first, _) = _joined(tmp_path, STEP).recordings
    assert not first.between and not np.isnan(first.measured("y")[1:]).any()
