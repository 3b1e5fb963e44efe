"""What every mechanism of the library declares, and that it is absent at zero and moved by each of its parameters."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.actuator import TorqueSaturation
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Range, Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Signals

# Names and kinds of port as users' scripts know them.
NAMES = {
    "body": """viscous_friction coulomb_friction stribeck_friction coulomb_asymmetry quadratic_drag load_dependent_friction
        position_dependent_friction friction_warmup presliding_hysteresis constant_bias gravity torque_ripple end_stop
        additional_mode unknown""",
    "coupling": "backlash nonlinear_stiffness hysteretic_spring nonlinear_damping transmission_error unknown",
    "balance": "constant_bias linear_leak threshold_flow unknown",
    "actuator": "input_delay input_lag input_bias input_gain torque_saturation actuator_deadzone unknown",
    "sensor": "output_delay sensor_lag sensor_bias sensor_gain unknown",
}
PURE_NUMBERS = {
    "gain_error",
    "order",
    "side",
    "zeta",
    "reaction",
    "sharpness",
    "softness",
    "asymmetry",
    "load_dependent_friction.c",
}

MECHANISMS = [pytest.param(m(), id=m.name) for m in LIBRARY.values()]
FORMS = [
    pytest.param(Unknown("speed", knots=5), id="unknown"),
    pytest.param(TorqueSaturation(by_direction=True), id="torque_saturation by direction"),
    pytest.param(TorqueSaturation(limited_power=True), id="torque_saturation of limited power"),
    pytest.param(ActuatorDeadzone(by_direction=True), id="actuator_deadzone by direction"),
    pytest.param(ActuatorDeadzone(soft=True), id="actuator_deadzone with round corners"),
]
ALL = [*MECHANISMS, *FORMS]
every = pytest.mark.parametrize("mechanism", ALL)


def memory_of(mechanism: Mechanism, around: Surroundings) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(2)
    return {state.name: rng.normal(size=500) for state in mechanism.states(around)}


def seen(mechanism: Mechanism, anywhere: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    needs = (mechanism.signal,) if isinstance(mechanism, Unknown) else mechanism.needs
    sampling = (
        {"sample_time": np.array(0.004)} if mechanism.name.endswith("_lag") or mechanism.name == "output_delay" else {}
    )
    return {name: anywhere[name] for name in needs or ("speed",)} | sampling


def amplitudes(mechanism: Mechanism, around: Surroundings) -> set[str]:
    return {name for probe in mechanism.probes(around) for name in probe.directions} - {SHARE}


@every
def test_has_the_name_and_the_ports_of_the_contract(mechanism: Mechanism) -> None:
    assert mechanism.kinds
    assert all(mechanism.name in NAMES[kind].split() for kind in mechanism.kinds)


@pytest.mark.parametrize(
    ("kind", "name"),
    [(kind, name) for kind, names in NAMES.items() for name in names.split() if name != "unknown"],
)
def test_library_has_every_name_of_the_contract(kind: str, name: str) -> None:
    assert kind in LIBRARY[name].kinds


@every
def test_says_what_it_is(mechanism: Mechanism) -> None:
    assert mechanism.explanation.endswith(".") and len(mechanism.explanation) > 30
    assert any(ch.isdigit() for ch in mechanism.source), "a source has a year"
    assert isinstance(mechanism, Unknown) or mechanism.experiment
    assert mechanism.__doc__


@every
def test_parameters(mechanism: Mechanism, around: Surroundings) -> None:
    parameters = mechanism.parameters(around)
    assert len({p.name for p in parameters}) == len(parameters) > 0
    for p in parameters:
        assert np.isfinite(p.value) and p.bounds[0] <= p.value <= p.bounds[1]
        assert p.description
        number = p.name in PURE_NUMBERS or f"{mechanism.name}.{p.name}" in PURE_NUMBERS
        assert bool(p.unit) != number, f"{p.name}: unit '{p.unit}'"
        assert p.unit.count("(") == p.unit.count(")")


@every
def test_units_of_a_place_in_metres(mechanism: Mechanism, around: Surroundings) -> None:
    units = {name: unit.replace("rad", "m") for name, unit in around.units.items()}
    for p in mechanism.parameters(Surroundings(around.ranges, units, "N", around.sample_time)):
        assert "N m" not in p.unit
        assert "rad" not in p.unit or p.name == "omega" or (p.name, p.unit) == ("order", "rad/m")
        assert p.name != "mass" or p.unit == "N s^2/m"


@every
def test_probes_name_parameters(mechanism: Mechanism, around: Surroundings) -> None:
    bounds = {p.name: p.bounds for p in mechanism.parameters(around)}
    probes = mechanism.probes(around)
    assert probes
    for probe in probes:
        assert probe.directions
        assert set(probe.directions) <= {*bounds, SHARE}
        assert not set(probe.directions) & set(probe.values), "a direction is zero, not given"
        for name in set(probe.directions) - {SHARE}:
            assert bounds[name][0] <= 0.0 <= bounds[name][1]
        for name, value in probe.values.items():
            assert bounds[name][0] <= value <= bounds[name][1], f"{name} = {value}"


@every
def test_every_shape_is_given_by_every_probe(mechanism: Mechanism, around: Surroundings) -> None:
    """Start values of shapes are guesses; what the screen looks at is stated in full (but for those that make no difference at zero)."""
    free = {p.name for p in mechanism.parameters(around) if not p.fixed}
    at_zero = {"stribeck_friction", "actuator_deadzone", "backlash"}
    for probe in mechanism.probes(around):
        left = free - set(probe.directions) - set(probe.values) - amplitudes(mechanism, around)
        assert mechanism.name in at_zero or not left


@every
def test_absent_at_zero_amplitude(mechanism: Mechanism, around, anywhere, law) -> None:
    zero = dict.fromkeys(amplitudes(mechanism, around), 0.0)
    if not zero:
        assert all(SHARE in probe.directions for probe in mechanism.probes(around))
        return
    signals = seen(mechanism, anywhere)
    value = law(mechanism, zero, memory_of(mechanism, around), **signals)
    expected = signals["deflection"] if mechanism.kinematic else np.zeros(500)
    assert np.array_equal(value, expected)


def beside(hook: str, mechanism: Mechanism, values: dict[str, float], signals: dict[str, np.ndarray]) -> np.ndarray:
    """A force of a kinematic law beside its change of deflection, which it sees changed."""
    s, p = (
        Signals("given", {n: torch.as_tensor(np.asarray(v, dtype=float)) for n, v in each.items()})
        for each in (signals, values)
    )
    force = getattr(mechanism, hook)(s.replaced(deflection=mechanism.deflection(s, p)), p)
    assert force is not None
    return force.numpy()


@every
def test_every_parameter_moves_the_law(mechanism: Mechanism, around, anywhere, law, rates) -> None:
    signals, memory = seen(mechanism, anywhere), memory_of(mechanism, around)
    parameters = mechanism.parameters(around)
    values = {p.name: p.value for p in parameters}
    for name in amplitudes(mechanism, around):
        values[name] = min(0.5, 0.6 * next(p for p in parameters if p.name == name).bounds[1])
    if "where" in values:
        values["where"] = 1.0
    if mechanism.name == "input_delay":  # its time shifts the records; the law sees the shifted signal
        return
    for p in parameters:
        other = {**values, p.name: values[p.name] - 0.05 * (abs(values[p.name]) or 1.0)}
        change = np.abs(law(mechanism, other, memory, **signals) - law(mechanism, values, memory, **signals)).max()
        if memory:
            moved = rates(mechanism, other, memory, **signals) - rates(mechanism, values, memory, **signals)
            change = max(change, np.abs(moved).max())
        hook = (
            {"reaction": "reaction", "damping": "force_beside", "k_2": "force_beside"}.get(p.name)
            if mechanism.kinematic
            else None
        )
        if hook is not None:
            forces = [beside(hook, mechanism, at, anywhere) for at in (other, values)]
            change = np.abs(forces[0] - forces[1]).max()
        assert change > 1e-6, p.name


@every
def test_is_finite_where_a_signal_never_moved(mechanism: Mechanism, around: Surroundings, law) -> None:
    still = Surroundings({n: Range(0.0, 0.0, 0.0) for n in around.ranges}, around.units, "N m", around.sample_time)
    for p in mechanism.parameters(still):
        assert np.isfinite(p.value)
    mechanism.probes(still)


@pytest.mark.parametrize(
    ("peak", "least", "lowest"), [(400.0, 8.0, 180.0), (3032.0, 28.8, 5.4)], ids=["usual", "peaks"]
)
def test_a_limit_is_looked_for_where_an_input_usually_is(peak: float, least: float, lowest: float) -> None:
    """Seen: a controller's output, 3032 A once and 180 A root mean square, of which the drive gave 10 A."""
    around = Surroundings({"input": Range(-peak, peak, 180.0)}, {}, "A", 0.01)
    law = TorqueSaturation()
    limit = law.parameters(around)[0]
    assert limit.lower == pytest.approx(least) and limit.upper == peak
    assert min(probe.values["limit"] for probe in law.probes(around)) == pytest.approx(lowest)
