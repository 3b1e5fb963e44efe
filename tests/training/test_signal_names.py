"""Networks that read inputs of the model and levels elsewhere, by the names that the model has for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.training.signal_names import local_names, spoken


class Room(gt.GreyBoxModel):
    """Air and wall; the sun is recorded, and used nowhere."""

    states = [gt.State("air", "degC", initial="measured"), gt.State("wall", "degC", initial=20.0)]
    inputs = [gt.Input("heater", "W"), gt.Input("sun", "W/m^2")]
    outputs = [gt.Output("air", "degC")]
    parameters = [gt.Parameter("C", 100.0, unit="J/K", fixed=True), gt.Parameter("k", 4.5, unit="W/K", lower=0.0)]
    ports = [gt.Balance("zone", level="air"), gt.Balance("mass", level="wall")]

    def derivative(self, x, u, p, port):
        flow = p.k * (x.air - x.wall)
        return {"air": (u.heater - flow + port.zone) / p.C, "wall": (flow + port.mass) / (50.0 * p.C)}

    def output(self, x, u, p):
        return {"air": x.air}


@pytest.fixture(scope="module")
def sunny() -> gt.DataSet:
    """A room that the sun heats with 2 m² · sun."""
    rng, runs, units = np.random.default_rng(0), [], {"heater": "W", "sun": "W/m^2", "air": "degC"}
    for name in ("one", "two"):
        heater, sun = (np.repeat(rng.uniform(0.0, 50.0, 20), 15) for _ in range(2))
        air, wall, seen = 20.0, 20.0, []
        for h, s in zip(heater, sun, strict=True):
            seen.append(air)
            for _ in range(10):
                flow = 5.0 * (air - wall)
                air, wall = air + 0.1 * (h - flow + 2.0 * s) / 100.0, wall + 0.1 * flow / 5000.0
        signals = {"heater": heater, "sun": sun, "air": np.array(seen) + rng.normal(0.0, 0.01, len(seen))}
        runs.append(gt.Recording.from_arrays(name, signals, sample_time=1.0, units=units))
    return gt.DataSet(runs, hold="zoh")


def test_the_names_of_the_model_are_those_of_the_port() -> None:
    room = Room()
    zone = room.ports[0]
    assert local_names(room, zone, ("air", "level", "wall", "sun", "none")) == (
        "level",
        "level",
        "level@mass",
        "input@sun",
        "none",
    )
    assert [spoken(s) for s in ("level", "input@sun", "level@mass")] == ["level", "sun", "level of mass"]


def test_a_network_over_an_input_that_the_model_does_not_use(sunny: gt.DataSet, tmp_path: Path) -> None:
    """Seen: "--signals air: there is no such signal at air; there is: level, time" of a building that lacks the sun."""
    settings = gt.TrainingSettings(epochs=20)
    found = gt.train(
        Room(), sunny, net="residual", port="zone", signals=["sun"], network={"units": 3}, settings=settings
    )
    gain = np.diff(found.force(sun=np.array([10.0, 40.0]))) / 30.0
    assert gain == pytest.approx(2.0, rel=0.15)
    assert found.explanation is not None and [c.told for c in found.explanation.curves] == ["sun"]
    learned = found.plot_learned()
    assert learned is not None and learned.axes[0].get_xlabel() == "sun [W/m^2]"
    found.save(tmp_path)
    again = gt.load(tmp_path / "model", model=Room())
    assert gt.simulate(again, sunny).scores == gt.simulate(found, sunny).scores


def test_what_a_network_may_read_is_told(sunny: gt.DataSet) -> None:
    with pytest.raises(
        gt.UserError, match=r'at zone \(did you mean "sun"\?\); there is: level, heater, sun, level@mass'
    ):
        gt.train(Room(), sunny, net="residual", port="zone", signals=["sunn"])
