"""Equations that give no number: at every value an error and nothing else, at the start of what was recorded where there are recordings."""

from __future__ import annotations

from typing import Literal

import pytest
import torch

import greybox_torch as gt
from greybox_torch.checking.examine import examine


class Gap(gt.GreyBoxModel):
    """A plate below a magnet: its force goes with the inverse square of the gap, which is never zero."""

    states = [gt.State("gap", "m", initial="measured"), gt.State("v", "m/s")]
    inputs = [gt.Input("force", "N")]
    outputs = [gt.Output("gap", "m")]
    parameters = [gt.Parameter("C", 1.0, unit="N m^2", lower=0.0), gt.Parameter("m", 1.0, unit="kg", fixed=True)]
    ports = [gt.Body("plate", speed="v", position="gap")]

    def derivative(self, x, u, p, port):
        return {"gap": x.v, "v": (u.force + port.plate - p.C / x.gap**2) / p.m}

    def output(self, x, u, p):
        return {"gap": x.gap}


def at_the_start(model: gt.GreyBoxModel, data: gt.DataSet | None = None) -> list[str]:
    return [f.found for f in gt.check(model, data).findings if "at the start" in f.found]


def test_the_start_is_the_one_of_the_recordings(data_set) -> None:
    """Seen: "where gap = 0" of a card whose recordings begin at 4 mm."""
    names, never_zero, zero = {"force": "N", "gap": "m"}, [0.01] * 20, [0.0] * 20
    assert at_the_start(Gap()) == [
        "the equations give no number at the start (states at their start values, measured ones and inputs at zero), where gap = 0"
    ]
    recorded = [{"force": [1.0] * 20, "gap": gap} for gap in (never_zero, zero)]
    assert at_the_start(Gap(), data_set(names, recorded[:1])) == []
    assert at_the_start(Gap(), data_set(names, recorded)) == [
        'the equations give no number at the start of "run 2", where gap = 0'
    ]


def test_a_parameter_of_zero_that_divides_is_an_error(data_set) -> None:
    """Seen: a heat capacity of 0 on the card: "can be used: 2 warnings", with torch.sqrt as advice."""
    model = Gap()
    model.set_values({"m": 0.0})
    data = data_set({"force": "N", "gap": "m"}, [{"force": [1.0] * 20, "gap": [0.01] * 20}])
    found = next(f for f in gt.check(model, data).findings if "at the start" in f.found)
    assert found.level == "error" and found.found.endswith(", where m = 0") and "sqrt" not in found.write
    assert found.write == "a value of m other than zero, and a bound that excludes it"


def test_no_number_anywhere_is_one_error() -> None:
    """Seen: "can be used: 5 warnings", three of them that parameters move nothing."""

    class Lost(Gap):
        def derivative(self, x, u, p, port):
            return {"gap": x.v, "v": (u.force + port.plate - float("nan") * p.C * x.gap) / p.m}

    (found,) = examine(Lost).findings
    assert (found.level, found.topic) == ("error", "numbers")
    assert "no number (nan or inf) at any of the values" in found.found
    assert not gt.check(Lost()).usable


def shares(initial: float | Literal["measured"], rest: float) -> type[gt.GreyBoxModel]:
    """Ten states between 0 and 1; with ``rest`` = 1 they are less than 1 together, as the fractions of a mixture are."""

    class Shares(gt.GreyBoxModel):
        states = [gt.State(f"s{i}", "", initial=initial) for i in range(10)]
        outputs = [gt.Output(f"s{i}", "") for i in range(10)]
        parameters = [gt.Parameter("k", 1.0, unit="1/s", lower=0.0)]
        ports = [gt.Balance("last", level="s9")]

        def derivative(self, x, u, p, port):
            last = torch.log(1.0 - torch.stack([x[f"s{i}"] for i in range(10)]).sum(0)) if rest else 0.0
            rates = {f"s{i}": p.k * (last - torch.log(x[f"s{i}"] / (1.0 - x[f"s{i}"]))) for i in range(10)}
            return {**rates, "s9": rates["s9"] + port.last}

        def output(self, x, u, p):
            return {f"s{i}": x[f"s{i}"] for i in range(10)}

    return Shares


def test_many_states_within_narrow_limits_are_no_error() -> None:
    """Seen: no random point is within all limits, and a model that can be simulated "cannot be used: 1 error"."""
    never = "no number (nan or inf) at any of the values that were tried"
    for made in (shares(0.5, 0.0), shares("measured", 0.0)):
        found = examine(made).findings
        assert {f.level for f in found} == {"warning"}
        assert not [f for f in found if never in f.found or "moves no output" in f.found]
    (found,) = examine(shares(0.05, 1.0)).findings
    assert found.level == "warning"
    assert never in found.found
    assert found.found.endswith("but they do where a simulation begins")
    assert [f.level for f in examine(shares(0.5, 1.0)).findings] == ["error"]


def test_the_start_that_many_states_have_is_the_one_of_the_recordings(data_set) -> None:
    units = {f"s{i}": "" for i in range(10)}
    recorded = [dict.fromkeys(units, [share] * 20) for share in (0.05, 0.5)]
    made = shares("measured", 1.0)
    levels = [
        [f.level for f in gt.check(made, data_set(units, [one])).findings if f.topic == "numbers"] for one in recorded
    ]
    assert levels == [["warning"], ["error"]]
    of_others = gt.check(made, data_set({"t0": ""}, [{"t0": [1.0] * 20}]))  # the card is what is to be mended
    assert {f.topic for f in of_others.findings if f.level == "error"} == {"card"}


def test_where_first_samples_are_missing_the_next_known_ones_are_the_start(data_set) -> None:
    missing = [float("nan")]
    recorded = [{"force": [*missing, *[1.0] * 19], "gap": [*missing, *[gap] * 19]} for gap in (0.01, 0.0)]
    told = [at_the_start(Gap(), data_set({"force": "N", "gap": "m"}, [one])) for one in recorded]
    assert told == [[], ['the equations give no number at the start of "run 1", where gap = 0']]


def test_numbers_far_from_zero_alone_are_enough() -> None:
    """Degrees above 300 K, a pressure that falls along a line: no random point around zero has them."""

    class Hot(gt.GreyBoxModel):
        states = [gt.State(f"T{i}", "K", initial=500.0 - i) for i in range(6)]
        outputs = [gt.Output("T5", "K")]
        parameters = [gt.Parameter("k", 1.0, lower=0.0)]
        ports = [gt.Balance("last", level="T5")]

        def derivative(self, x, u, p, port):
            steps = [torch.sqrt(x[f"T{i}"] - x[f"T{i + 1}"]) for i in range(5)]
            flows = [*steps, torch.sqrt(x.T5 - 300.0)]
            rates = [(flows[i - 1] if i else 0.0) - flows[i] for i in range(6)]
            return {f"T{i}": p.k * rates[i] + (port.last if i == 5 else 0.0) for i in range(6)}

        def output(self, x, u, p):
            return {"T5": x.T5}

    found = examine(Hot).findings
    assert {f.level for f in found} == {"warning"}
    assert [f for f in found if "at 128 of 128 random points" in f.found]
    assert not [f for f in found if "moves no output" in f.found]


class Orifice(gt.GreyBoxModel):
    """A volume that fills through an orifice from a supply of 200 bar."""

    states = [gt.State("pressure", "Pa", initial="measured"), gt.State("valve", "")]
    inputs = [gt.Input("command", "")]
    outputs = [gt.Output("pressure", "Pa")]
    parameters = [gt.Parameter("k", 1e3, unit="Pa^0.5/s", lower=0.0), gt.Parameter("ps", 200e5, unit="Pa", fixed=True)]
    ports = [gt.Balance("oil", level="pressure")]

    def derivative(self, x, u, p, port):
        flow = p.k * x.valve * torch.sqrt(p.ps - 40.0 * x.pressure)
        return {"pressure": flow + port.oil, "valve": (u.command - x.valve) / 0.1}

    def output(self, x, u, p):
        return {"pressure": x.pressure}


def test_recorded_values_are_tried_where_there_are_recordings(data_set) -> None:
    """Seen: "nothing is wrong with it that shows without data" of a card whose pressures the root does not allow."""
    assert not [f for f in gt.check(Orifice()).findings if f.topic == "numbers"]
    names = {"command": "", "pressure": "Pa"}
    low, high = (
        [{"command": [1.0 + k for k in range(20)], "pressure": [step * k + 1e4 for k in range(20)]}]
        for step in (1e4, 1e5)
    )
    fine = gt.check(Orifice(), data_set(names, low))
    assert not fine.findings and fine.sentence.endswith("nothing is wrong that shows without a simulation.")
    (found,) = [f for f in gt.check(Orifice(), data_set(names, high)).findings if f.topic == "numbers"]
    assert (
        found.level == "warning"
        and "at 15 of 20 recorded samples, whatever the other states are, such as" in found.found
    )
    assert "pressure = 5.1e+05, command = 6" in found.found and found.line is not None


def test_a_line_of_which_random_points_have_told_is_not_told_again(data_set) -> None:
    class Tank(Orifice):
        def derivative(self, x, u, p, port):
            return {"pressure": torch.sqrt(x.pressure - 2e5) + port.oil, "valve": u.command - x.valve}

    recorded = [{"command": [1.0] * 20, "pressure": [3e5 if k < 10 else 1e5 for k in range(20)]}]
    found = [f.found for f in gt.check(Tank(), data_set({"command": "", "pressure": "Pa"}, recorded)).findings]
    assert sum("no number" in one for one in found) == 1


def test_a_parameter_of_0_that_divides_is_an_error(data_set) -> None:
    """Seen: "can be used", advice on roots, and of fit that no change of one parameter avoids it: 0 times anything is 0."""

    class Massless(Gap):
        parameters = (gt.Parameter("C", 1e-5, unit="N m^2"), gt.Parameter("m", 0.0, unit="kg"))

    data = data_set({"force": "N", "gap": "m"}, [{"force": [1.0] * 20, "gap": [0.01] * 20}])
    (found,) = (f for f in gt.check(Massless(), data).findings if "at the start" in f.found)
    assert found.level == "error" and found.found.endswith("where m = 0")
    assert found.write == "a value of m other than zero, and a bound that excludes it"
    data = data_set({"force": "N", "gap": "m"}, [{"force": [1.0] * 20, "gap": [0.01, 0.011] * 10}])
    with pytest.raises(gt.NumericalError, match=r"it does not with m = 1 kg \(now 0\)"):
        gt.fit(Massless(), data)
