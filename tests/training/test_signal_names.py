"""Networks that read inputs of the model and levels elsewhere, by the names that the model has for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.mechanisms.network import spoken
from greybox_torch.training.signal_names import local_names, names_in_model, told_names


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
    told = names_in_model(room, zone, ("level", "level@mass", "input@sun", "time"))
    assert told == ("air", "wall", "sun", "time"), 'seen: "inputs input@wind/level/input@outside"'
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
        gt.UserError, match=r'at zone \(did you mean "sun"\?\); there is: level, heater, sun, wall, time'
    ):
        gt.train(Room(), sunny, net="residual", port="zone", signals=["sunn"])
    for wrong, meant in (("wal", "wall"), ("airr", "air"), ("levle", "level")):
        with pytest.raises(gt.UserError, match=rf"signals: found '{wrong}'.*did you mean \"{meant}\""):
            gt.train(Room(), sunny, net="residual", port="zone", signals=[wrong])


class Drum(gt.GreyBoxModel):
    """A drum whose oil gets warm; its temperature is recorded, and used nowhere."""

    states = [gt.State("speed", "rad/s", initial="measured")]
    inputs = [gt.Input("torque", "N m"), gt.Input("oil", "degC")]
    outputs = [gt.Output("speed", "rad/s")]
    parameters = [gt.Parameter("J", 0.5, unit="kg m^2", fixed=True)]
    ports = [gt.Body("drum", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": (u.torque + port.drum) / p.J}

    def output(self, x, u, p):
        return {"speed": x.speed}


@pytest.fixture(scope="module")
def oiled() -> gt.DataSet:
    rng, runs = np.random.default_rng(0), []
    for name in ("one", "two"):
        torque, oil = np.repeat(rng.uniform(-5.0, 5.0, 20), 15), np.repeat(rng.uniform(20.0, 60.0, 20), 15)
        speed, seen = 1.0, []
        for u, warm in zip(torque, oil, strict=True):
            seen.append(speed)
            for _ in range(10):
                speed += 0.01 * (u - (1.5 - 0.02 * warm) * speed) / 0.5
        signals = {"torque": torque, "oil": oil, "speed": np.array(seen) + rng.normal(0.0, 0.01, len(seen))}
        units = {"torque": "N m", "oil": "degC", "speed": "rad/s"}
        runs.append(gt.Recording.from_arrays(name, signals, sample_time=0.1, units=units))
    return gt.DataSet(runs, hold="zoh")


@pytest.mark.parametrize("net", ["friction", "residual", "memory"])
def test_every_network_over_an_input_is_kept_and_exported(oiled: gt.DataSet, tmp_path: Path, net: str) -> None:
    settings = gt.TrainingSettings(epochs=3)
    found = gt.train(Drum(), oiled, net=net, signals=["speed", "oil"], network={"units": 2}, settings=settings)
    found.save(tmp_path / "found")
    again = gt.load(tmp_path / "found" / "model", model=Drum())
    names = [parameter.name for parameter in again.declared_parameters]
    assert f"drum.{net}_net.input_oil_centre" in names and not [name for name in names if "@" in name]
    assert gt.simulate(again, oiled).scores == gt.simulate(found, oiled).scores
    for to in ("c", "torch"):
        written = gt.export(again, to=to, data=oiled).save(tmp_path / to)
        assert written and "input@" not in "".join(file.read_text() for file in written)


def test_names_are_told_as_they_are_read() -> None:
    room = Room()
    zone, mass = room.ports
    assert told_names(room, zone, ("level", "level@mass", "input@sun", "time")) == ("level", "wall", "sun", "time")
    assert told_names(room, mass, ("level", "level@zone")) == ("level", "air")


def test_what_two_balances_exchange_is_not_read_by_a_network(sunny: gt.DataSet) -> None:
    """It would push one of the two alone."""
    with pytest.raises(gt.UserError, match="found 'difference@mass', there is no such signal at zone"):
        gt.train(Room(), sunny, net="residual", port="zone", signals=["difference@mass"])
