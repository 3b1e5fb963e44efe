"""A term by which the warmer of two temperatures cools the other is told, with its line."""

from __future__ import annotations

import greybox_torch as gt


class Zone(gt.GreyBoxModel):
    """Air and walls of a building zone."""

    states = [gt.State("air", "degC", initial="measured"), gt.State("wall", "degC", initial=17.0)]
    inputs = [gt.Input("heater", "W"), gt.Input("outside", "degC")]
    outputs = [gt.Output("air", "degC")]
    parameters = [
        gt.Parameter("C_air", 1e6, unit="J/K", lower=1e4),
        gt.Parameter("C_wall", 1e7, unit="J/K", lower=1e5),
        gt.Parameter("k_air", 150.0, unit="W/K", lower=0.0),
        gt.Parameter("k_wall", 70.0, unit="W/K", lower=0.0),
    ]
    ports = [gt.Balance("air", level="air"), gt.Balance("wall", level="wall")]

    def derivative(self, x, u, p, port):
        flow = p.k_air * (x.air - x.wall)
        return {
            "air": (u.heater - flow + port.air) / p.C_air,
            "wall": (flow - p.k_wall * (x.wall - u.outside) + port.wall) / p.C_wall,
        }

    def output(self, x, u, p):
        return {"air": x.air}


class Turned(Zone):
    """Two signs are turned: of the flow into the wall, and of the outside temperature."""

    def derivative(self, x, u, p, port):
        flow = p.k_air * (x.air - x.wall)
        return {
            "air": (u.heater - flow + port.air) / p.C_air,
            "wall": (-flow - p.k_wall * (x.wall + u.outside) + port.wall) / p.C_wall,
        }


def told(model: gt.GreyBoxModel) -> list[str]:
    found = [f for f in gt.check(model).findings if "warmer" in f.found]
    assert all(f.level == "note" and f.line for f in found)
    return [f.found for f in found]


def test_heat_that_flows_from_the_colder_to_the_warmer() -> None:
    """Seen: a turned sign, a fit of 58 % with C_wall = 2.6e14 J/K, and not a word of it."""
    assert told(Zone()) == []
    assert told(Turned()) == [
        "a warmer air cools wall, where heat flows from the warmer to the colder",
        "a warmer outside cools wall, where heat flows from the warmer to the colder",
    ]
