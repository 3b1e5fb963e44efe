"""Where a channel is read with the wrong scale, an estimate and a diagnosis ask whether it is right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api import rescaled, short_refits
from greybox_torch.api.rescaled import MOST_CHANNELS
from tests.api.test_exchanged import Plate, fitted, recordings


@pytest.mark.parametrize(
    ("sign", "asked"),
    [
        (
            {"T2": 0.01},
            "Is the scale of T2 right? With values 100 times as large, a short refit reaches a mean fit of 9",
        ),
        (
            {"T1": 1000.0},
            "Is the scale of T1 right? With values 1000 times smaller, a short refit reaches a mean fit of 9",
        ),
        (
            {"P2": 0.001},
            "Is the scale of P2 right? With values 1000 times as large, a short refit reaches a mean fit of 9",
        ),
    ],
)
def test_a_wrong_scale_of_one_channel_is_asked_for(sign: dict[str, float], asked: str) -> None:
    """Seen: a pressure in bar read a hundred times too small, a fit of 21 %, and not a word."""
    question = fitted(None, **sign).question
    assert (
        question is not None
        and question.startswith(asked)
        and " % on the validation experiments instead of" in question
    )


def test_a_diagnosis_asks_it_too() -> None:
    """Seen: a pressure in bar read a hundred times too small, told as a lag of its sensor (0.85)."""
    question = gt.diagnose(Plate(), recordings(T2=0.01), time_limit=2).verdict.question
    assert question is not None and "the scale of T2 right? With values 100 times as large" in question


@pytest.mark.parametrize(("unit", "factor", "zero"), [("K", 1.0, 273.15), ("degF", 1.8, 32.0)])
def test_a_temperature_in_another_unit_is_asked_for(unit: str, factor: float, zero: float) -> None:
    """Seen: a floor of 287 K read as degC with a scale of 1, a fit of 30 %, and not a word of 273."""
    data = recordings()
    runs = [replace(r, signals={**r.signals, "T2": factor * r.signals["T2"] + zero}) for r in data.recordings]
    question = gt.fit(Plate(), gt.DataSet(runs, channels=data.channels)).question
    assert question is not None
    assert question.startswith(f"Is T2 recorded in {unit}? Converted to degC, a short refit reaches a mean fit of 9")


def test_only_what_the_start_values_bear_out_is_refitted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A factor that free parameters make up for is none that the card is asked about."""
    refits: list[float] = []

    def fit_after(data, model, simulator, change, *, refitted=True) -> float:
        if refitted:
            refits.append(change.factor)
        return 90.0 if refitted and change.read else 20.0 if change.factor != 10.0 else 40.0

    for module in (rescaled, short_refits):
        monkeypatch.setattr(module, "fit_after", fit_after)
    asked = rescaled.rescaled(recordings(), Plate(), None, 10.0)  # pyright: ignore[reportArgumentType]
    assert (
        refits == [1.0, 10.0, 10.0, 10.0]
        and asked is not None
        and "90 %" in asked.question
        and "instead of 20 %" in asked.question
        and asked.reaches == 90.0
    )
    refits.clear()
    for module in (rescaled, short_refits):
        monkeypatch.setattr(module, "fit_after", lambda *given, refitted=True: 20.0)
    assert rescaled.rescaled(recordings(), Plate(), None, 10.0) is None  # pyright: ignore[reportArgumentType]


def test_factors_of_times_and_angles_are_tried_where_the_unit_has_them() -> None:
    inputs = (gt.Input("speed", "rad/s"), gt.Input("force", "N"))
    outputs = tuple(gt.Output(f"T{k}", "degC") for k in range(MOST_CHANNELS + 1))
    changes = list(rescaled._changes(type("Oven", (), {"inputs": inputs, "outputs": outputs})))  # pyright: ignore
    factors = {name: {c.factor for c in changes if name in c.read} for name in ("speed", "force", "T0")}
    assert len(factors["force"]) == 6 and factors["T0"] == set()
    own = [1 / 60, np.pi / 180, np.pi / 30, 30 / np.pi, 180 / np.pi, 60.0]
    assert sorted(factors["speed"] - factors["force"]) == pytest.approx(own)
    assert 10.0 in factors["force"] and 10.0 not in factors["speed"], "nothing tells it from 9.55"
    told = {c.factor: c.question for c in changes if "speed" in c.read}
    assert (
        told[180 / np.pi] == "Is the scale of speed right? With values 57.3 times as large (rad and deg differ by that)"
    )
    assert told[np.pi / 30].endswith("With values 9.55 times smaller (rpm and rad/s differ by that)")
    assert told[1 / 60].endswith("With values 60 times smaller (s and min differ by that)")


class Drive(gt.GreyBoxModel):
    """A motor behind a spring, with the spring's torque measured."""

    states = [gt.State("a", "rad"), gt.State("w", "rad/s")]
    inputs = [gt.Input("torque", "N m")]
    outputs = [gt.Output("w", "rad/s"), gt.Output("a", "rad"), gt.Output("spring", "N m")]
    parameters = [
        gt.Parameter("J", 10.0, unit="kg m^2", lower=1e-6),
        gt.Parameter("k", 0.4, unit="N m/rad", lower=0.0),
        gt.Parameter("b", 0.01, unit="N m s/rad", lower=0.0),
    ]
    ports = [gt.Body("rotor", speed="w", position="a")]

    def derivative(self, x, u, p, port):
        return {"a": x.w, "w": (u.torque - p.k * x.a - p.b * x.w + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"w": x.w, "a": x.a, "spring": p.k * x.a}


def bench(seed: int, role: str) -> gt.Recording:
    """The drive with dry friction that the model lacks, and the spring's torque in N mm."""
    draw = np.random.default_rng(seed)
    torque = np.repeat(draw.uniform(-1.0, 1.0, 20), 40)
    a, w, rows = 0.0, 0.0, []
    for u in torque:
        rows.append((w, a))
        for _ in range(5):
            w += 0.002 * (u - 3.0 * a - 0.15 * w - 0.05 * np.tanh(w / 0.02)) / 0.1
            a += 0.002 * w
    speed, angle = np.array(rows).T + 1e-3 * draw.normal(size=(2, 800))
    signals = {"torque": torque, "w": speed, "a": angle, "spring": 3000.0 * angle}
    units = {"torque": "N m", "w": "rad/s", "a": "rad", "spring": "N m"}
    return gt.Recording.from_arrays(f"run {seed}", signals, sample_time=0.01, units=units, role=role)


def test_an_output_that_is_lost_is_asked_by_what_the_others_lead_to() -> None:
    """Seen: an encoder without its gear of 100, and a torque in N mm, beside start values far off: "far better with none of these"."""
    found = gt.fit(Drive(), gt.DataSet([bench(1, "estimation"), bench(2, "validation")]))
    assert found.question is not None
    assert found.question.startswith(
        "Is the scale of spring right? With values 1000 times smaller, a short refit reaches"
    )
