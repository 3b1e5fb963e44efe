"""From looks to hypotheses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import identity_of, shortlist
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import SHARE, Probe
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.unknown import Unknown


def score(mechanism, explained: float, *size: float, directions=(), port="rotor", **values: float) -> ScreenScore:
    probe = Probe(directions or ("bias",), values)
    return ScreenScore(Attachment(port, mechanism), probe, 100, explained, np.array(size))


@pytest.fixture
def fit(stub):
    return stub(problem=stub(values_by_name={"J": 0.02, "b": 0.05}))


@pytest.fixture
def found(dead_zone_search, fit, stub, motor):
    study = stub(
        problem=stub(model=motor),
        card={"J": 0.01, "b": 0.1},
        surroundings=dead_zone_search.surroundings,
        settings=DiagnosisSettings(),
        budget=SearchBudget(),
    )
    return lambda *looks: shortlist(study, looks, [fit] * len(looks))


def names(found) -> list[str]:
    return [candidate.attachment.mechanism.name for candidate in found]


def test_friction_that_would_drive_is_passed_over(found) -> None:
    driving = score(CoulombFriction(), 0.9, -1.0, directions=("F_c",), v_0=0.1)
    opposing = score(CoulombFriction(), 0.3, 1.0, directions=("F_c",), v_0=0.2)
    assert found([driving]) == []
    (candidate,) = found([driving, opposing])
    assert candidate.explained == 0.3
    assert candidate.starts[0]["rotor.coulomb_friction.v_0"] == 0.2


def test_one_physical_direction_of_several_is_enough_and_starts_stay_in_bounds(found) -> None:
    (candidate,) = found([score(StribeckFriction(), 0.4, -0.2, 0.5, directions=("F_c", "F_s"), v_s=1.0, v_0=0.2)])
    assert candidate.starts[0]["rotor.stribeck_friction.F_c"] == 0.0
    assert candidate.starts[0]["rotor.stribeck_friction.F_s"] == 0.5


def test_share_of_an_effect_is_not_negative_and_no_parameter(found) -> None:
    lag = score(InputLag(), 0.5, 0.8, directions=(SHARE,), port="actuator", T=0.06)
    assert found([score(InputLag(), 0.5, -0.8, directions=(SHARE,), port="actuator", T=0.06)]) == []
    (candidate,) = found([lag])
    assert candidate.starts[0] == {"J": 0.01, "b": 0.1, "actuator.input_lag.T": 0.06}


def test_starts_are_the_card_and_the_fit(found) -> None:
    (candidate,) = found([score(ConstantBias(), 0.5, 0.3)])
    assert candidate.starts == (
        {"J": 0.01, "b": 0.1, "rotor.constant_bias.bias": 0.3},
        {"J": 0.02, "b": 0.05, "rotor.constant_bias.bias": 0.3},
    )


def test_the_same_at_two_lengths_is_one_hypothesis(found) -> None:
    short, long = score(ConstantBias(), 0.1, 0.3), score(ConstantBias(), 0.6, 0.4)
    (candidate,) = found([short], [long])
    assert candidate.explained == 0.6
    assert [s["rotor.constant_bias.bias"] for s in candidate.starts] == [0.4, 0.4, 0.3, 0.3]


@pytest.mark.parametrize(
    ("other", "taken_over"), [(Unknown("position", 4), True), (Unknown("position", 5), False), (None, False)]
)
def test_a_curve_begins_with_no_heights_of_another_ones_knots(found, other, taken_over) -> None:
    """The second height of 14 knots along the whole way is no force over the second of ten along a part of it."""
    other = other or Unknown("position", 4, part=(0.1, 0.2))

    def seen(curve: Unknown, explained: float, height: float) -> ScreenScore:
        heights = tuple(f"w_{k}" for k in range(curve.knots))
        return score(curve, explained, *([height] * curve.knots), directions=heights)

    (candidate,) = found([seen(Unknown("position", 4), 0.9, 1.0)], [seen(other, 0.6, 2.0)])
    assert candidate.explained == 0.9
    assert any(start["rotor.unknown.w_0"] == 2.0 for start in candidate.starts) is taken_over


def test_it_is_known_over_which_windows_an_effect_shows_most(found) -> None:
    weak, strong = (score(ConstantBias(), e, 0.3) for e in (0.1, 0.6))
    for order in ([weak], [replace(strong, length=400)]), ([replace(strong, length=400)], [weak]):
        (candidate,) = found(*order)
        assert candidate.steps == 400


def test_best_first_nothing_tiny_not_all_and_a_curve_beside_the_named(found) -> None:
    ripples = [score(TorqueRipple(k + 2.0), 0.9 - 0.05 * k, 1.0, 1.0, directions=("a", "b")) for k in range(10)]
    curve = score(Unknown("speed"), 0.01, *np.ones(14), directions=tuple(f"w_{k}" for k in range(14)))
    tiny = score(ConstantBias(), 1e-4, 0.3)
    chosen = found([*ripples, curve, tiny])
    assert names(chosen)[0] == "torque_ripple" and names(chosen)[-1] == "unknown"
    assert "constant_bias" not in names(chosen)
    shares = [candidate.explained for candidate in chosen]
    assert shares == sorted(shares, reverse=True) and len(shares) < 10


def test_numbers_that_are_not_are_passed_over(found) -> None:
    assert found([score(ConstantBias(), np.nan, 0.3)]) == []


def test_identity() -> None:
    same = [identity_of(Attachment("rotor", TorqueRipple(order))) for order in (7.301, 7.302, 7.4)]
    assert same[0] == same[1] != same[2]
    assert identity_of(Attachment("a", Unknown("speed"))) != identity_of(Attachment("a", Unknown("position")))
    assert identity_of(Attachment("a", ConstantBias())) != identity_of(Attachment("b", ConstantBias()))


@pytest.mark.parametrize(("own", "ports"), [(0.327, ["actuator", "rotor"]), (0.15, ["actuator"]), (0.0, ["actuator"])])
def test_beside_a_drives_gain_over_speed_the_bodys_friction_is_asked(found, own, ports) -> None:
    """Seen: dry friction of a winch's drum, larger in one direction, told as something unknown at the drive (0.97)."""
    gain = score(Unknown("speed", factor="input"), 0.330, 1.0, directions=("w_1",), port="actuator")
    friction = [score(Unknown("speed"), own, 1.0, directions=("w_1",))] if own else []
    curves = [score(Unknown("position"), 0.329, 1.0, directions=("w_1",)), *friction]
    assert [c.attachment.port for c in found([gain, *curves])] == ports
    own_input = score(Unknown("input"), 0.330, 1.0, directions=("w_1",), port="actuator")
    assert [c.attachment.port for c in found([own_input, *curves])] == ["actuator"]


@pytest.mark.parametrize(("alone", "factor"), [(0.9871, ""), (0.98, "input@voltage")])
def test_a_curve_is_multiplied_by_an_input_only_where_that_leaves_less(found, alone, factor) -> None:
    """Seen: evaporation from a bath in a room of nearly constant temperature, its curve times that of the room: 14 % left elsewhere."""
    times = score(Unknown("speed", factor="input@voltage"), 0.9877, 1.0, directions=(SHARE,))
    (candidate,) = found([times, score(Unknown("speed"), alone, 1.0, directions=(SHARE,))])
    assert getattr(candidate.attachment.mechanism, "factor", None) == factor
