"""Where an effect is strongest: along which signal, in which experiment, when."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.held_out import timelines
from greybox_torch.diagnosis.describe.profiles import profile
from greybox_torch.diagnosis.describe.signal_names import as_named, signal_name
from greybox_torch.diagnosis.describe.where import where
from greybox_torch.diagnosis.effect import Curve, Profile, Timeline
from greybox_torch.diagnosis.factor import Factor
from greybox_torch.mechanisms.actuator import TorqueSaturation
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.windows import cut
from tests.machines.geared_drum import GearedDrum

STEP = 0.5


@pytest.fixture
def fits(stub):
    """Fits of windows of so many samples on two experiments of 8 and 4 samples, of which the windows' energies are given."""
    count = 12
    records = Records(
        np.zeros((1, count)),
        np.zeros((1, count)),
        np.full(count, STEP),
        np.array([0, 8]),
        np.array([7, 11]),
        ("A", "B"),
        "zoh",
    )
    return lambda length, *energies: stub(
        windows=cut(records, length), energies=np.array(energies), problem=stub(records=records)
    )


def test_shares_along_each_experiment(fits) -> None:
    first, second = timelines((fits(4, 5.0, 2.0, 9.0),), (fits(4, 4.0, 3.0, 6.0),))
    assert (first.experiment, second.experiment) == ("A", "B")
    np.testing.assert_allclose(first.edges, [0.0, 2.0, 3.5])
    np.testing.assert_allclose(second.edges, [0.0, 1.5])
    np.testing.assert_allclose(first.share, [0.25, 0.0])  # where the effect costs a little it explains nothing
    np.testing.assert_allclose(second.share, [0.75])
    assert second.intensity == pytest.approx(0.5)


def test_windows_that_both_could_be_fitted_on(fits) -> None:
    short, long = fits(4, 5.0, 2.0, 9.0), fits(8, 7.0, 9.0)
    assert timelines((short,), (long,)) == ()
    assert timelines((), ()) == ()
    assert len(timelines((long, short), (long, short))) == 2


def test_nothing_gained_anywhere(fits) -> None:
    same = fits(4, 5.0, 2.0, 9.0)
    assert all(np.all(t.share == 0.0) for t in timelines((same,), (same,)))


def test_in_words() -> None:
    profile = Profile("gear_twist", "rad", np.array([-0.1, 0.0, 0.1, 0.2]), np.array([0.1, 0.8, 0.1]))
    long = Timeline("Steps", np.array([0.0, 10.0]), np.array([0.6]))
    short = Timeline("Validation 2", np.array([0.0, 1.0]), np.array([0.4]))
    told = "80 % of what it explains lies within 0 < gear_twist < 0.1 rad"
    assert where([profile], [long, short]) == f"{told}, strongest in Validation 2"
    assert where([profile], [long]) == where([profile], []) == told
    assert where([], []) == "what it explains is spread over the whole recordings"
    assert where([], [long, short]) == "what it explains is spread over the whole recordings, strongest in Validation 2"


@pytest.mark.parametrize(
    ("port", "signal", "name"),
    [
        ("gear", "position", "motor"),
        ("actuator", "position", "motor"),
        ("actuator", "speed", "w_m"),
        ("actuator", "input", "torque"),
        ("actuator", "delayed", "delayed torque"),
        ("sensor.drum", "output", "drum"),
        ("gear", "deflection", "gear.deflection"),
        ("drum", "position@motor_shaft", "motor"),
        ("gear", "input@torque", "torque"),
    ],
)
def test_signals_by_the_names_that_the_model_gives_them(port, signal, name) -> None:
    drum = GearedDrum()
    (site,) = (p for p in drum.all_ports if p.name == port)
    assert signal_name(drum, site, signal) == name


def test_a_curve_over_a_signal_of_another_port_goes_by_its_own_name() -> None:
    """Seen: a battery's heat drawn over "level@charge", where the sentence above said soc."""
    drum = GearedDrum()
    (site,) = (p for p in drum.all_ports if p.name == "drum")
    own, other = (Curve(signal, "rad", np.zeros(2), np.zeros(2), "N m") for signal in ("speed", "position@motor_shaft"))
    named = as_named(other, drum, site)
    assert named is not None and named.signal == "motor" and named.values is other.values
    assert as_named(own, drum, site) is own and as_named(None, drum, site) is None
    multiplied = as_named(replace(own, factor=Factor("speed@motor_shaft", "rad/s", 2.0)), drum, site)
    assert multiplied is not None and multiplied.factor == Factor("w_m", "rad/s", 2.0) and multiplied.signal == "speed"


def test_an_interval_of_nearly_the_whole_range_is_not_told() -> None:
    """Seen: "82 % of what it explains lies within -8.49 < angle < 4.08 rad", of -8.65 to 5.9."""
    even = Profile("angle", "rad", np.linspace(-8.65, 5.9, 41), np.full(40, 1 / 40))
    assert where((even,), ()) == "what it explains is spread over the whole recordings"
    half = Profile("angle", "rad", np.linspace(-8.65, 5.9, 41), np.repeat([1 / 20, 0.0], 20))
    assert "lies within -8.65 < angle < -2.8" in where((half,), ())


EDGES = np.linspace(-1.0, 87.0, 89)


@pytest.mark.parametrize(
    ("beyond", "told"),
    [
        ((9.651, 77.91), "it acts where ball < 9.651 or ball > 77.91 mm"),
        ((None, 77.91), "it acts where ball > 77.91 mm"),
        (None, "80 % of what it explains lies within 35 < ball < 86 mm"),
    ],
)
def test_a_law_that_acts_beyond_limits_alone_is_told_with_them(beyond, told: str) -> None:
    """Seen: "81 % of what it explains lies within 34.8 < ball < 86 mm" of stops at 9.7 and 77.9 mm: errors go on after the contact."""
    share = np.where((EDGES[:-1] >= 35) & (EDGES[:-1] < 86), 0.801 / 51, 0.199 / 37)
    assert where([Profile("ball", "mm", EDGES, share)], [], beyond) == told


@pytest.mark.parametrize(("samples", "told"), [(0.77, False), (0.5, True)])
def test_an_interval_in_which_the_samples_lie_anyway_is_not_told(samples: float, told: bool) -> None:
    inside = (EDGES[:-1] >= 35) & (EDGES[:-1] < 86)
    share, seen = (np.where(inside, part / 51, (1.0 - part) / 37) for part in (0.801, samples))
    assert ("lies within 35 < ball < 86" in where([Profile("ball", "mm", EDGES, share, seen)], [])) is told


def test_a_level_of_steps_is_told_as_one() -> None:
    """Seen: "100 % of what it explains lies within 22.5 < Q1 < 23.1 %" of an input that is 22.5 % there."""
    levels = np.repeat([22.5, 25.0, 15.0, 30.0], 50)
    found = profile("Q1", "%", levels, np.where(levels == 22.5, 1.0, 0.0))
    assert where([found], []) == "100 % of what it explains lies where Q1 = 22.5 %"
    assert (
        where([profile("Q1", "%", levels, np.ones(200))], []) == "what it explains is spread over the whole recordings"
    )


@pytest.mark.parametrize(
    ("law", "values", "beyond"),
    [
        (EndStop(both=True), {"low": 9.0, "high": 78.0}, (9.0, 78.0)),
        (EndStop(), {"where": 78.0, "side": 1.0}, (None, 78.0)),
        (EndStop(), {"where": 9.0, "side": -1.0}, (9.0, None)),
        (LIBRARY["threshold_flow"](), {"threshold": 30.0, "width": 2.0}, (None, 26.0)),
        (TorqueSaturation(True), {"limit": 2.0, "asymmetry": 0.5, "softness": 0.0}, (-1.0, 3.0)),
        (TorqueSaturation(), {"limit": 2.0, "softness": 0.5}, None),
        (LIBRARY["viscous_friction"](), {"c": 1.0}, None),
    ],
)
def test_which_laws_act_beyond_limits_alone(law: Mechanism, values, beyond) -> None:
    assert law.acts_beyond(values) == beyond
