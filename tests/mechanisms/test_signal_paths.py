"""Laws at one actuator or sensor stand one behind the other; expected signals are made by NumPy alone."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.actuator import InputDelay, InputGain, InputLag, TorqueSaturation
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import SHARE, Surroundings
from greybox_torch.mechanisms.sensor import SensorBias, SensorGain, SensorLag
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Signals
from tests.mechanisms.attaching import STEP, Tank, at, attached, free_run, records_of, starts, values_of

TANK = Tank()
TIME = STEP * np.arange(450)


def level(pump: np.ndarray, k: float = 0.3) -> np.ndarray:
    """The tank's level for an inflow that is constant over every sample, exactly."""
    decay, result = np.exp(-k * STEP), [1.0]
    for u in pump[:-1]:
        result.append(result[-1] * decay + u / k * (1 - decay))
    return np.array(result)


def lagged(u: np.ndarray, t: float, begin: float, hold: bool = True) -> np.ndarray:
    """A first-order lag of an input that is held, and its mean over every sample; at the sample times where it is not held."""
    decay, now, mean, ends = np.exp(-STEP / t), begin, [], [begin]
    for value in u:
        mean.append(value + (now - value) * t / STEP * (1 - decay))
        now = value + (now - value) * decay
        ends.append(now)
    return np.array(mean if hold else ends[:-1])


def simulated(around: Surroundings, *effects: tuple[object, dict[str, float]], port: str = "actuator") -> np.ndarray:
    model = attached(TANK, around, *(at(port, law) for law, _ in effects))
    given = {f"{law.name}.{n}": v for law, values in effects for n, v in values.items()}
    records = records_of(len(TIME))
    p = values_of(model, **given)
    first = np.zeros(1, dtype=np.int64)
    x0 = model.begun(starts(model, np.array([[1.0]])), model.prepared(records, p), first, p)
    return free_run(model, records, p, x0)[0]


def test_a_gain_behind_a_limit_is_of_what_the_limit_passes(around) -> None:
    """Before, both were of the recorded input: beyond its limit a saturated drive went on growing by its gain's error."""
    u = records_of(len(TIME)).u[0]
    limit, gain = (TorqueSaturation(), {"limit": 1.5}), (InputGain(), {"gain_error": -0.2})
    np.testing.assert_allclose(simulated(around, limit, gain), level(0.8 * np.clip(u, -1.5, 1.5)), atol=1e-9)
    np.testing.assert_allclose(simulated(around, gain, limit), level(np.clip(0.8 * u, -1.5, 1.5)), atol=1e-9)


@pytest.mark.parametrize("lag_first", [True, False])
def test_the_order_of_a_lag_and_a_limit_is_that_in_which_they_are_attached(around, lag_first) -> None:
    u, t = records_of(len(TIME)).u[0], 0.05
    lag, limit = (InputLag(), {"T": t}), (TorqueSaturation(), {"limit": 1.5})
    found = simulated(around, *((lag, limit) if lag_first else (limit, lag)))
    before = lagged(np.clip(u, -1.5, 1.5), t, np.clip(u[0], -1.5, 1.5))
    behind = np.clip(lagged(u, t, u[0]), -1.5, 1.5)
    right, wrong = (behind, before) if lag_first else (before, behind)
    tolerance = 1e-4 if lag_first else 1e-7  # within a sample the limit bends what the lag passes
    np.testing.assert_allclose(found, level(right), atol=tolerance)
    assert np.abs(found - level(wrong)).max() > 100 * tolerance


def test_a_dead_time_comes_first_wherever_it_was_attached(around) -> None:
    dead, late = (ActuatorDeadzone(), {"half_width": 0.7}), (InputDelay(), {"T": 10 * STEP})
    one, other = simulated(around, dead, late), simulated(around, late, dead)
    np.testing.assert_array_equal(one, other)
    u = records_of(len(TIME)).u[0]
    delayed = np.concatenate([np.full(10, u[0]), u[:-10]])
    passed = np.sign(delayed) * np.maximum(np.abs(delayed) - 0.7, 0.0)
    np.testing.assert_allclose(one, level(passed), atol=1e-9)


def test_laws_at_a_sensor_stand_one_behind_the_other(around) -> None:
    port = next(p.name for p in TANK.all_ports if p.kind == "sensor")
    true, t = level(records_of(len(TIME)).u[0]), 0.05
    lag, gain = (SensorLag(), {"T": t}), (SensorGain(), {"gain_error": 0.5})
    bias = (SensorBias(), {"bias": 0.2})
    found = simulated(around, lag, gain, bias, port=port)
    fine = np.interp(STEP / 50 * np.arange(50 * len(TIME)), TIME, true)
    slow = [true[0]]
    for value in 0.5 * (fine[1:] + fine[:-1]):
        slow.append(value + (slow[-1] - value) * np.exp(-STEP / 50 / t))
    np.testing.assert_allclose(found, 1.5 * np.array(slow)[::50] + 0.2, atol=2e-5)
    np.testing.assert_allclose(simulated(around, gain, lag, bias, port=port), found, atol=1e-9)
    turned = simulated(around, bias, gain, port=port)
    np.testing.assert_allclose(turned, 1.5 * (true + 0.2), atol=1e-9)


def test_a_memory_begins_with_what_the_laws_before_it_pass_on(around) -> None:
    model = attached(
        TANK, around, at("actuator", InputGain()), at("actuator", InputLag()), at("actuator", TorqueSaturation())
    )
    records, first = records_of(10), np.zeros(1, dtype=np.int64)
    p = values_of(model, gain_error=0.5, **{"input_lag.T": 0.05}, limit=99.0)
    begun = model.begun(starts(model, np.array([[1.0]])), records, first, p)
    assert begun[0, 1] == pytest.approx(1.5 * records.u[0, 0])
    port = next(q.name for q in TANK.all_ports if q.kind == "sensor")
    twice = attached(TANK, around, at(port, SensorBias()), at(port, SensorLag()))
    p = values_of(twice, bias=0.25, **{"sensor_lag.T": 0.05})
    assert twice.begun(starts(twice, np.array([[1.0]])), records, first, p)[0, 1] == pytest.approx(1.25)


def test_looks_of_a_screen_see_what_is_there_and_leave_one_another_alone(around) -> None:
    there, looks = at("actuator", TorqueSaturation()), (at("actuator", InputGain()), at("actuator", ActuatorDeadzone()))
    model = attached(TANK, around, there, *looks, probed=looks)
    values = dict(model.values()) | {"actuator.torque_saturation.limit": 1.5, "actuator.input_gain.gain_error": 1.0}
    values |= {f"{a.prefix}.{SHARE}": 0.5 for a in looks} | {"actuator.actuator_deadzone.half_width": 0.7}
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in values.items()})
    x = Signals("state", {"level": torch.tensor(0.0, dtype=torch.float64)})
    u = Signals("input", {"pump": torch.tensor(4.0, dtype=torch.float64)})
    acting = float(model.derivative(x, u, p, model.local.no_forces())["level"])
    assert acting == pytest.approx(1.5 + 0.5 * 1.5 - 0.5 * 0.7)


def test_a_free_curve_among_the_looks_is_of_the_signal_before_all_laws(around) -> None:
    """It may stand for any of them: what the data say in the place of a law is a curve of the signal that the law sees."""
    there, look = at("actuator", InputGain()), at("actuator", Unknown("input", 8))
    model = attached(TANK, around, there, look, probed=[look])
    heights = {n: 0.1 * k for k, n in enumerate(n for n in model.values() if ".w_" in n)}
    values = dict(model.values()) | {"actuator.input_gain.gain_error": 0.5} | heights
    values |= {n: 1.0 for n in values if n.endswith(f".{SHARE}")}
    plain = attached(TANK, around, look, probed=[look])

    def acting(of: AugmentedModel, pump: float) -> float:
        own = {n: v for n, v in values.items() if n in dict(of.values())}
        p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in own.items()})
        x = Signals("state", {"level": torch.tensor(0.0, dtype=torch.float64)})
        u = Signals("input", {"pump": torch.tensor(pump, dtype=torch.float64)})
        return float(of.derivative(x, u, p, of.local.no_forces())["level"])

    for pump in (-2.0, 0.5, 3.0):
        curve = acting(plain, pump) - pump
        assert abs(curve) > 1e-6
        assert acting(model, pump) == pytest.approx(1.5 * pump + curve)
