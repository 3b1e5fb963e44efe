"""A simulated fleet: what is drawn, and that its recordings are what its key says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from experiments.fleets.generate import NOISE, write_fleet
from experiments.fleets.plan import KINDS, draw_fleet


def test_what_is_drawn() -> None:
    drawn = draw_fleet(64, 10, seed=3)
    assert drawn == draw_fleet(64, 10, seed=3)
    assert drawn != draw_fleet(64, 10, seed=4)
    without = [m for m in drawn if not m.effect]
    changed = [m for m in drawn if m.changed is not None]
    assert len(without) == 16
    assert len(changed) == 24
    assert {m.effect for m in drawn} == {"", *KINDS}
    for machine in drawn:
        assert list(machine.dates) == sorted(set(machine.dates))
        assert len(machine.dates) == 10
    for machine in changed:
        assert machine.changed is not None
        before, after = np.split(np.array(machine.sizes), [machine.changed])
        assert len(before) >= 4
        assert len(after) >= 4
        assert after.min() > 1.2 * before.max()
    assert {m.sizes[0] == 0.0 for m in changed} == {True, False}  # some appear, others grow
    for machine in without:
        assert set(machine.sizes) == {0.0}


def test_recordings_follow_the_key(tmp_path: Path) -> None:
    """The plain model fits a machine without effects down to the noise, and not one with Coulomb friction."""
    machine = next(m for m in draw_fleet(16, 2, seed=0) if m.effect == "coulomb" and m.changed is None)
    bare = replace(machine, name="bare", sizes=(0.0, 0.0))
    cards = write_fleet([machine, bare], tmp_path, samples=200, seed=0)
    assert cards[2] == tmp_path / "bare" / machine.dates[0] / "dataset.toml"
    errors = []
    for card in (cards[0], cards[2]):
        data = gt.load_dataset(card)
        assert data.model is not None
        fitted = gt.fit(gt.load_model(data.model), data)
        errors.append([row["refit"]["rmse"] for row in fitted.to_dict()["fit"]])
    assert np.min(errors[0]) > 5.0 * NOISE
    assert np.max(errors[1]) == pytest.approx(NOISE, rel=0.2)
