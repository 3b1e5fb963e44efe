"""The final fits on whole records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.coarser import sampled
from greybox_torch.diagnosis.hypothesis.above_noise import noise_over_windows
from greybox_torch.diagnosis.hypothesis.final import _from_the_card, as_windows_have_it, finish
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.problem import make_problem
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.unknown import Unknown

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()


@pytest.fixture(scope="module")
def search(motor_data, motor, begun):
    found = begun(motor_data(torque=lambda q, v: 0.05, noise=0.02), motor)
    return found.at(found.refitted((attach(motor, "rotor", ConstantBias()),), found.plain))


def lost(hypothesis, name: str):
    """The hypothesis as if windows had led to where whole records overflow."""
    fits = []
    for fit in hypothesis.fits:
        values = fit.problem.values.copy()
        values[fit.problem.names.index(name)] = 1e-9
        fits.append(replace(fit, problem=fit.problem.with_values(values)))
    return replace(hypothesis, fits=tuple(fits))


def test_the_card_has_the_machine_and_the_windows_have_the_effect(search) -> None:
    """Only what the machine has itself begins anew: an effect's size on the card is none."""
    begins, windows = _from_the_card(search.current), search.current.values()
    values = dict(zip(begins.names, begins.values, strict=True))
    assert values["rotor.constant_bias.bias"] == windows["rotor.constant_bias.bias"] == pytest.approx(0.05, rel=0.05)
    card = dict(zip(search.problem.names, search.problem.values, strict=True))
    assert {n: values[n] for n in card} == card and card != {n: windows[n] for n in card}


def test_where_windows_led_astray_the_card_is_a_beginning(search) -> None:
    right, astray = finish(search.current), finish(lost(search.current, "J"))
    assert astray.uncertainty is not None
    assert np.allclose(astray.problem.values, right.problem.values, rtol=1e-3)


def test_what_was_found_with_some_of_the_samples_is_fitted_to_all(motor_data, motor, begun) -> None:
    """Four times as many say it twice as exactly."""
    data = motor_data(torque=lambda q, v: 0.05, noise=0.02)
    found = begun(sampled(data, 4, ["voltage"]), motor)
    bias = found.refitted((attach(motor, "rotor", ConstantBias()),), found.plain)
    some, every = finish(bias), finish(bias, records=make_problem(data, motor, data.estimation()).records)
    assert every.problem.records.y.shape[1] == 2000
    for name, deviation in every.deviations().items():
        assert some.deviations()[name] == pytest.approx(2.0 * deviation, rel=0.2)
        assert every.values()[name] == pytest.approx(some.values()[name], abs=4.0 * some.deviations()[name])


def test_the_values_of_windows_have_the_deviations_that_they_scatter_by(motor_data, motor, begun) -> None:
    """Seen: a balancer's lag, 14.3 ms, told with a deviation of 990 ms: that of free runs which are lost."""
    scores = []
    for seed in range(6):
        found = begun(motor_data(torque=lambda q, v: 0.05, noise=0.05, seed=seed), motor)
        final = as_windows_have_it(found.refitted((attach(motor, "rotor", ConstantBias()),), found.plain))
        true = {"J": 0.02, "b": 0.05, "rotor.constant_bias.bias": 0.05}
        scores += [(final.values()[n] - value) / final.deviations()[n] for n, value in true.items()]
    assert 0.5 < float(np.sqrt(np.mean(np.square(scores)))) < 1.6


def test_deviations_of_windows_are_by_name_wherever_a_curve_stands(motor_data, motor, begun) -> None:
    """They were those of other parameters behind a curve: what decides whether an effect says something read them."""
    search = begun(motor_data(torque=lambda q, v: 0.02 * np.cos(0.1 * v) + 0.03, noise=0.02), motor)
    curve, lag = attach(motor, "rotor", Unknown("speed", 8)), attach(motor, "actuator", InputLag())
    start = [{**search.plain.values(), "actuator.input_lag.T": 0.01}]
    one = search.refitted((lag, curve), search.plain, start)
    other = search.refitted((curve, lag), search.plain, [one.values()])
    deviations, behind = (as_windows_have_it(h).deviations() for h in (one, other))
    assert set(behind) == set(deviations) and "actuator.input_lag.T" in behind
    for name, deviation in deviations.items():
        assert behind[name] == pytest.approx(deviation, rel=0.05), name


@pytest.mark.parametrize("loud", [False, True], ids=["weighed by their spectrum", "weighed alike"])
def test_deviations_beside_a_curve_allow_for_its_heights(motor_data, motor, begun, loud: bool) -> None:
    """Seen: a wall's conductance of 89.915 ± 0.019 W/K beside a curve (true 90.0); with the curve's heights unknown it is ± 0.15."""
    search = begun(motor_data(torque=lambda q, v: 0.02 * np.cos(0.1 * v), noise=0.02), motor)
    curve = search.refitted((attach(motor, "rotor", Unknown("speed", 8)),), search.plain)
    if loud:
        curve = replace(curve, fits=tuple(replace(f, mean_square=9.0 * f.mean_square) for f in curve.fits))
    for final in (finish(curve), as_windows_have_it(curve)):
        held, told = final.deviations(), final.told.deviations()
        assert final.told.values() == final.values()
        assert {f"rotor.unknown.w_{k}" for k in range(8)} == told.keys() - {"J", "b"}
        assert held.keys() == {"J", "b"} and all(np.isfinite(one) for one in told.values())
    held, told = finish(curve).deviations(), finish(curve).told.deviations()
    assert told["b"] > 5.0 * held["b"], "what is proportional to the speed, the curve can do as well"
    assert finish(search.plain).with_curves is None


def test_that_bumps_were_left_out_is_no_knowledge_where_the_values_of_windows_stand(motor_data, motor, begun) -> None:
    """As where whole records were fitted. What decides about effects goes by the deviations beside the curve as it is."""
    search = begun(motor_data(torque=lambda q, v: 0.02 * np.cos(0.1 * v), noise=0.02), motor)
    curve = search.refitted((attach(motor, "rotor", Unknown("speed", 8, left_out=(1, 3, 4, 6))),), search.plain)
    final = as_windows_have_it(curve)
    held, told = final.deviations(), final.told.deviations()
    assert held.keys() == {"J", "b"} and final.of_windows and final.told.of_windows
    assert {f"rotor.unknown.w_{k}" for k in range(8)} == told.keys() - {"J", "b"}
    assert final.told.values().items() >= final.values().items() and np.isfinite(told["b"])
    print(held, told)
    assert told["b"] > 2.0 * held["b"], "what is proportional to the speed, the whole curve can do as well"
    assert as_windows_have_it(search.plain).with_curves is None


def test_drift_beside_an_effect_does_not_bend_the_machine(motor_data, motor, begun) -> None:
    """Noise over windows, a slow voltage over the whole record: errors weighed by their spectrum leave the parameters where they are."""
    drift = 0.02 * np.sin(np.linspace(0.0, 9.0, 2000))
    search = begun(motor_data(acting=lambda v: v + 0.3 + drift, noise=0.05), motor)
    drifting = search.refitted((attach(motor, "rotor", ConstantBias()),), search.plain)
    assert drifting is not None and noise_over_windows(drifting, SETTINGS)
    loud = replace(drifting, fits=tuple(replace(f, mean_square=9.0 * f.mean_square) for f in drifting.fits))
    true = np.array([0.02, 0.05])
    weighed, plain = (finish(h) for h in (drifting, loud))
    away = [np.abs([f.values()[n] for n in ("J", "b")] / true - 1.0).max() for f in (weighed, plain)]
    assert away[0] < 0.5 * away[1]
    assert weighed.uncertainty is not None and plain.uncertainty is not None
    assert weighed.sentences() and not plain.sentences()
    assert (weighed.uncertainty.plain == weighed.uncertainty.sandwich).all()
    assert not np.allclose(plain.uncertainty.plain, plain.uncertainty.sandwich)
