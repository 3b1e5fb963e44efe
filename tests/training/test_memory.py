"""A network with hidden states learns a lag that no network without them can."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.errors import UserError
from greybox_torch.systems import load_model

STEP, LAG = 0.01, 0.12


def recorded(name: str, role: str, hold: int, seed: int) -> gt.Recording:
    """The documentation's motor behind a drive with a lag of 0.12 s, by Euler's rule with 20 steps a sample; noise of 0.01 rad/s."""
    rng = np.random.default_rng(seed)
    voltage = np.repeat(rng.uniform(-3, 3, 600 // hold), hold)
    speeds, acting, speed = [0.0], voltage[0], 0.0
    for v in voltage[:-1]:
        for _ in range(20):
            acting += STEP / 20 * (v - acting) / LAG
            speed += STEP / 20 * (0.1 * acting - 0.05 * speed) / 0.02
        speeds.append(speed)
    signals = {"voltage": voltage, "speed": np.array(speeds) + rng.normal(0, 0.01, len(voltage))}
    return gt.Recording.from_arrays(
        name, signals, sample_time=STEP, role=role, units={"voltage": "V", "speed": "rad/s"}
    )


@pytest.fixture(scope="module")
def trained(machines) -> gt.TrainingResult:
    data = gt.DataSet(
        [recorded("a", "estimation", 20, 1), recorded("b", "estimation", 12, 2), recorded("c", "validation", 15, 3)]
    )
    motor = load_model(f"{machines / 'motor.py'}:Motor")
    return gt.train(
        motor, data, net="memory", port="actuator", network={"units": 3}, settings=gt.TrainingSettings(epochs=25)
    )


def test_the_free_run_on_held_out_recordings(trained) -> None:
    fit = {row["model"]: row["fit"] for row in trained.scores if row["experiment"] == "c"}
    assert fit["refit"] < 70.0 and fit["augmented"] > 90.0


def test_it_says_how_long_it_remembers(trained) -> None:
    (memory,) = trained.explanation.memories
    assert memory == pytest.approx(LAG, rel=0.3)
    assert trained.explanation.sentence.startswith(f"The network remembers over {memory:.2g} s")


def test_saved_and_loaded(trained, tmp_path, machines) -> None:
    trained.save(tmp_path)
    loaded = gt.load(tmp_path / "model", model=f"{machines / 'motor.py'}:Motor")
    again, before = (gt.simulate(model, trained.data)["c"]["speed"] for model in (loaded, trained.model))
    np.testing.assert_array_equal(again, before)


@pytest.mark.parametrize("memories", [0, 5, 1.5, True])
def test_how_many_hidden_states(memories) -> None:
    with pytest.raises(UserError, match=r"memory_net: memories is .*; expected a whole number from 1 to 4"):
        gt.MemoryNet(("speed",), memories=memories)
