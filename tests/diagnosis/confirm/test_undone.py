"""How much of what an effect does the other parameters undo."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import undone
from greybox_torch.diagnosis.confirm.undone import not_undone
from greybox_torch.mechanisms.actuator import TorqueSaturation
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.sensor import SensorGain
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.unknown import Unknown

NAMES = ("k", "sensor.sensor_gain.gain_error", "b")


@pytest.fixture
def fitted(monkeypatch: pytest.MonkeyPatch, stub: Any) -> Any:
    """A hypothesis whose outputs' slopes (samples, parameters) at one length of windows or more are given."""

    def made(*slopes: np.ndarray | None, names: tuple[str, ...] = NAMES, effects: tuple[Attachment, ...] = ()) -> Any:
        monkeypatch.setattr(undone, "window_information", lambda fit, simulator: None if fit is None else fit.T @ fit)
        values = dict.fromkeys(names, -0.5)
        return stub(problem=stub(free_names=names), values=lambda: values, fits=slopes, simulator=None, effects=effects)

    return made


def around() -> dict[str, Surroundings]:
    ranges = {n: Range(-1.0, 1.0, 0.5) for n in ("output", "speed", "position")}
    return {"sensor": Surroundings(ranges, {}, "", 1e-3), "sensor.": Surroundings(ranges, {}, "", 1e-3)}


GAIN = Attachment("sensor", SensorGain())


def test_share_is_that_of_the_slope_beside_the_span_of_the_others(fitted) -> None:
    rng = np.random.default_rng(1)
    slopes = rng.normal(size=(50, 3))
    slopes[:, 1] = 3.0 * slopes[:, 0] - 2.0 * slopes[:, 2] + 0.1 * rng.normal(size=50)
    others = slopes[:, [0, 2]]
    beside = slopes[:, 1] - others @ np.linalg.lstsq(others, slopes[:, 1], rcond=None)[0]
    expected = (beside @ beside) / (slopes[:, 1] @ slopes[:, 1])
    assert not_undone(fitted(slopes), GAIN, around()) == pytest.approx(expected, rel=1e-9)
    assert expected < 0.01


def test_the_shortest_windows_decide(fitted) -> None:
    """Seen: among the longest windows one that was about to slip, whose slopes outweighed all others."""
    undone_there = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    apart = np.eye(3)
    assert not_undone(fitted(undone_there, apart, apart), GAIN, around()) == pytest.approx(0.0, abs=1e-12)
    assert not_undone(fitted(apart, undone_there), GAIN, around()) == pytest.approx(1.0)


def test_one_where_windows_cannot_be_simulated_or_show_nothing_of_it(fitted) -> None:
    assert not_undone(fitted(None), GAIN, around()) == 1.0
    assert not_undone(fitted(np.diag([1.0, 0.0, 1.0])), GAIN, around()) == 1.0


def test_only_amplitudes_count_as_what_an_effect_does(fitted) -> None:
    """The order of a ripple may be as uncertain as it likes beside the stiffness."""
    ripple = Attachment("sensor", TorqueRipple(3.0))
    names = ("k", *(f"sensor.torque_ripple.{n}" for n in ("a", "b", "order")))
    slopes = np.array([[1.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
    assert not_undone(fitted(slopes, names=names), ripple, around()) == pytest.approx(1.0)


def test_a_free_curve_undoes_nothing(fitted) -> None:
    """Otherwise dry friction would be taken back beside a curve over the same speed."""
    curve, friction = Attachment("rotor", Unknown("speed", 5)), Attachment("rotor", CoulombFriction())
    names = ("rotor.unknown.w_1", "rotor.coulomb_friction.F_c", "k")
    slopes = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.001, 0.0]])
    surroundings = {"rotor": around()["sensor"]}
    assert not_undone(fitted(slopes, names=names, effects=(curve, friction)), friction, surroundings) == pytest.approx(
        1.0
    )
    assert not_undone(fitted(slopes, names=names), friction, surroundings) < 1e-6


def test_of_a_limit_that_is_what_counts_not_its_softness(fitted) -> None:
    limit = Attachment("actuator", TorqueSaturation())
    names = ("k", "actuator.torque_saturation.limit", "actuator.torque_saturation.softness")
    slopes = np.array([[1.0, 0.0, 5.0], [0.0, 1.0, 0.0]])
    assert not_undone(fitted(slopes, names=names), limit, {"actuator": around()["sensor"]}) == pytest.approx(1.0)
