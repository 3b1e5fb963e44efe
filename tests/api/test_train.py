"""Training from Python."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import greybox_torch as gt
from tests.api.motor import Motor, check_shown, numbers, told


def test_train(folder: Path, data: gt.DataSet) -> None:
    model, options = Motor(), ("--net", "residual", "--port", "actuator", "--units", "4", "--epochs", "5")
    settings = gt.TrainingSettings(epochs=5)
    found = gt.train(model, data, net="residual", port="actuator", network={"units": 4}, settings=settings)
    assert numbers(found.to_dict()) == numbers(told(folder, "train", *options))
    assert found.parameters["actuator.residual_net.out_0"].unit == "V" and model.held_values() == {}
    assert found.model.held_values() == {row["name"]: row["value"] for row in found.parameter_rows}
    assert found.explanation is not None and found.explanation.term is not None and found.named is not None
    by_model = {(row["model"], row["experiment"]): row["fit"] for row in found.scores}
    compared = gt.compare(data, {"augmented": found, "named": found.named})
    for row in compared.scores:
        assert row["fit"] == pytest.approx(by_model[row["model"], row["experiment"]], abs=1e-6)
    assert found.force(input=np.array([2.0])).shape == (1,) and isinstance(found.plot_learned(), Figure)
    learned = found.plot_learned()
    assert learned is not None and learned.legends and learned.axes[0].get_legend() is None, "seen: over the note"
    files = {f"{name}.{kind}" for name in ("model", "named") for kind in ("json", "safetensors")}
    check_shown(found, folder / "saved", {"train.json", "learned.png", *files})
    assert gt.load(folder / "saved" / "named").values() == found.named.values()


def test_a_training_that_explains_nothing(folder: Path, data: gt.DataSet) -> None:
    """Trained from the values that the model holds, on the very start values that a fit of it has."""
    model = Motor()
    model.set_values({"J": 0.02, "b": 0.05})
    options = {"net": "residual", "port": "actuator", "network": {"units": 2}}
    found = gt.train(model, data, settings=gt.TrainingSettings(epochs=1), explain=False, **options)
    assert (found.explanation, found.named, found.plot_learned()) == (None, None, None)
    start = [row["fit"] for row in found.scores if row["model"] == "start"]
    assert start == [row["fit"] for row in gt.simulate(model, data).scores]
    check_shown(found, folder / "saved", {"train.json", "model.json", "model.safetensors"})


def test_nothing_is_learned_from_a_machine_at_rest() -> None:
    still = {"voltage": np.linspace(0, 1, 100), "speed": np.zeros(100)}
    data = gt.DataSet([gt.Recording.from_arrays("Rest", still, sample_time=0.01, role="estimation")])
    with pytest.raises(gt.UserError, match=r"no output moves in the experiments of role 'estimation' \(speed"):
        gt.train(Motor(), data)
