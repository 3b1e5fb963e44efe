"""Fitted parameters that describe nothing on the machine are said to, and sound ones are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.mechanisms.library import LEARNED, LIBRARY
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.mechanisms.unknown_fading import UnknownFading
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory
from greybox_torch.mechanisms.varying_friction import PositionDependentFriction

# In the surroundings of conftest: speed −20 to 16 rad/s, position −3 to 5 rad, level 0.5 to 4 m, 10 s at 1 ms.
SOUND: dict[str, dict[str, float]] = {
    "stribeck_friction": {"F_c": 1.0, "F_s": 0.5, "c": 0.1, "v_s": 2.0, "v_0": 0.1},
    "presliding_hysteresis": {"F": 1.0, "z_0": 0.1},
    "friction_warmup": {"delta": 0.5, "T": 3.0, "v_0": 0.1},
    "position_dependent_friction": {"a": 0.5, "b": 0.0, "order": 3.0, "v_0": 0.1},
    "torque_ripple": {"a": 0.5, "b": 0.1, "order": 6.0},
    "end_stop": {"k": 500.0, "where": 4.5, "c": 1.0, "side": 1.0},
    "additional_mode": {"mass": 0.1, "omega": 60.0, "zeta": 0.05},
    "hysteretic_spring": {"F": 1.0, "z_0": 0.01, "sharpness": 0.0},
    "transmission_error": {"a": 0.01, "b": 0.0, "order": 3.0, "damping": 0.0, "reaction": 1.0},
    "threshold_flow": {"c": 1.0, "threshold": 2.0, "width": 0.1},
    "input_lag": {"T": 0.01},
    "torque_saturation": {"limit": 4.0, "softness": 0.3},
    "coulomb_friction": {"F_c": 1.0, "v_0": 0.1},
    "viscous_friction": {"c": 0.2},
}


def law_of(name: str) -> Mechanism:
    special = {
        "position_dependent_friction": PositionDependentFriction(3.0),
        "transmission_error": TransmissionError(3.0),
    }
    if name == "torque_ripple":
        return LIBRARY[name](order=6.0)  # type: ignore[call-arg]
    return special.get(name) or LIBRARY[name]()


def small(values: dict[str, float]) -> dict[str, float]:
    return {name: 0.01 * abs(value) + 1e-9 for name, value in values.items()}


@pytest.mark.parametrize("name", SOUND)
def test_sound_parameters_are_not_objected_to(name: str, around: Surroundings) -> None:
    law, values = law_of(name), SOUND[name]
    assert set(values) == {p.name for p in law.parameters(around)}
    assert law.degenerate(around, values, small(values)) is None


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("presliding_hysteresis", {"z_0": 15.9}, "z_0 = 15.9 is more than position moved in all, 8 rad"),
        ("hysteretic_spring", {"z_0": 0.2}, "z_0 = 0.2 is more than deflection moved in all, 0.11 rad"),
        ("stribeck_friction", {"v_s": 20.0}, "v_s = 20 is above every recorded speed, 20 rad/s"),
        ("friction_warmup", {"T": 0.002}, "T = 0.002 s is shorter than 3 samples of 0.001 s"),
        ("friction_warmup", {"T": 21.0}, "T = 21 s is far longer than the longest record, 10 s"),
        ("input_lag", {"T": 21.0}, "T = 21 s is far longer than the longest record, 10 s"),
        ("end_stop", {"where": 5.8}, "where = 5.8 lies outside of where position was, -3 to 5 rad"),
        ("end_stop", {"where": 2.5}, "31 % of the travel lies beyond it: no stop gives way so far"),
        ("end_stop", {"where": 1.0, "side": -1.0}, "50 % of the travel lies beyond it"),
        ("threshold_flow", {"threshold": 0.4}, "threshold = 0.4 lies outside of where level was, 0.5 to 4 m"),
        (
            "torque_ripple",
            {"order": 1.5},
            "order = 1.5 repeats 1.9 times in the travel; 2 are needed to see that it does",
        ),
        ("torque_ripple", {"order": 1.01}, "order = 1.01: once per turn is what weight does"),
        ("torque_ripple", {"order": 300.0}, "order = 300 leaves 1.5 samples a period at the usual speed"),
        ("position_dependent_friction", {"order": 1.2}, "order = 1.2 repeats 1.5 times in the travel"),
        ("transmission_error", {"order": 1.0}, "order = 1 repeats 1.3 times in the travel"),
        ("additional_mode", {"omega": 1.0}, "omega = 1 rad/s swings 1.6 times in the longest record; 2 are needed"),
        ("additional_mode", {"zeta": 1.8}, "its damping ratio of 1.8 lets nothing resonate"),
        (
            "additional_mode",
            {"omega": 930.0},
            "omega = 930 rad/s is at its most, 942 rad/s: its mass moves with the body",
        ),
        ("additional_mode", {"omega": 3500.0}, "omega = 3.5e+03 rad/s is above the Nyquist frequency, 3.14e+03 rad/s"),
        ("torque_saturation", {"limit": 6.0}, "limit = 6 is at its upper bound"),
        ("torque_saturation", {"softness": 1.0}, "softness = 1 is at its upper bound"),
    ],
)
def test_what_lies_outside_of_the_recordings_is_said(name: str, change: dict[str, float], said: str, around) -> None:
    values = {**SOUND[name], **change}
    assert str(law_of(name).degenerate(around, values, small(values))).startswith(said)


def test_a_mode_far_above_what_the_inputs_excite_moves_with_the_body(around: Surroundings) -> None:
    """Seen: a cart's gain, told as a mode of 18 Hz (0.75) where the force has 6 Hz; real modes lay below 0.8 of that."""
    mode, values = law_of("additional_mode"), SOUND["additional_mode"]
    assert mode.degenerate(replace(around, excited=40.0), values, small(values)) is None
    said = mode.degenerate(replace(around, excited=25.0), values, small(values))
    assert said == "omega = 60 rad/s is far above what the inputs excite, up to 25 rad/s: its mass moves with the body"


@pytest.mark.parametrize("name", SOUND)
def test_an_amplitude_below_its_deviation_is_said(name: str, around: Surroundings) -> None:
    law, values = law_of(name), SOUND[name]
    wide = {name: 2.0 * abs(value) + 1e-9 for name, value in values.items()}
    assert "its standard deviation" in str(law.degenerate(around, values, wide))


def test_what_makes_it_stribeck_counts(around: Surroundings) -> None:
    """F_s = 14716 ± 101910 is no Stribeck effect, however sure the Coulomb level beside it."""
    values = {**SOUND["stribeck_friction"], "F_s": 14716.0}
    said = law_of("stribeck_friction").degenerate(around, values, {**small(values), "F_s": 101910.0})
    assert said == "F_s = 1.47e+04 is smaller than its standard deviation 1.02e+05"


def test_one_sure_amplitude_of_two_is_enough(around: Surroundings) -> None:
    values = SOUND["torque_ripple"]
    assert law_of("torque_ripple").degenerate(around, values, {**small(values), "b": 5.0}) is None


def test_of_several_amplitudes_one_beyond_its_deviation_may_be_chance(around: Surroundings) -> None:
    """Seen: friction over the position with six amplitudes, each about one deviation, beside backlash that was all there was."""
    law = PositionDependentFriction(3.0, harmonics=3)
    names = law.amplitudes(around)
    values = {"order": 3.0, "v_0": 0.1, **dict.fromkeys(names, 0.02)}
    deviations = {**small(values), **dict.fromkeys(names, 0.015)}
    assert len(names) == 6 and "2.1 times its standard deviation" in str(law.degenerate(around, values, deviations))
    assert law.degenerate(around, values | {names[3]: 0.04}, deviations) is None


@pytest.mark.parametrize(("order", "seen"), [(2.99, True), (3.0, True), (2.9, False), (2.0, False), (1.0, False)])
def test_less_than_two_periods_are_enough_for_a_whole_order(order: float, seen: bool, around: Surroundings) -> None:
    """Of poles, slots and teeth there are whole numbers; other curves look like a wave of any order."""
    swing = replace(
        around, ranges={**around.ranges, "position": replace(around.ranges["position"], low=-0.9, high=0.9)}
    )
    values = SOUND["torque_ripple"] | {"order": order}
    assert (TorqueRipple(order).degenerate(swing, values, small(values)) is None) is seen
    in_metres = replace(swing, units={**swing.units, "position": "m"})
    assert TorqueRipple(order).degenerate(in_metres, values, small(values)) is not None


@pytest.mark.parametrize(("order", "reach", "seen"), [(1.0, 4.8, True), (1.03, 4.8, False), (1.0, 2.0, False)])
def test_friction_once_per_turn_is_a_bent_shafts_and_a_torque_a_weights(order, reach, seen, around) -> None:
    """Seen: a crane's slewing ring that rubs four times as much on one side, over 1.6 turns; told as plain friction (0.85)."""
    swing = replace(
        around, ranges={**around.ranges, "position": replace(around.ranges["position"], low=-reach, high=reach)}
    )
    values = SOUND["position_dependent_friction"] | {"order": order}
    assert (PositionDependentFriction(order).degenerate(swing, values, small(values)) is None) is seen
    ripple = SOUND["torque_ripple"] | {"order": order}
    assert TorqueRipple(order).degenerate(swing, ripple, small(ripple)) is not None


def test_zero_is_a_natural_bound_and_so_is_true_sticking(around: Surroundings) -> None:
    values = {**SOUND["coulomb_friction"], "v_0": law_of("coulomb_friction").parameters(around)[1].bounds[0]}
    assert law_of("coulomb_friction").degenerate(around, values, small(values)) is None
    values = {**SOUND["end_stop"], "c": 0.0}
    assert law_of("end_stop").degenerate(around, values, small(values)) is None


@pytest.mark.parametrize(
    ("width", "objection"), [(0.05, None), (0.4, None), (0.41, "highest at a speed, not near standstill")]
)
def test_stribeck_friction_is_highest_near_standstill(around, width: float, objection: str | None) -> None:
    """Seen: an eddy current brake whose torque is highest at a tenth of the speeds, told as Stribeck friction at the wrong body."""
    values = SOUND["stribeck_friction"] | {"v_0": width, "v_s": 2.0}
    told = law_of("stribeck_friction").degenerate(around, values, small(values))
    assert told is None if objection is None else told is not None and told.endswith(objection)
    narrow = values | {"v_0": 0.04, "v_s": 0.12}  # 0.2 and 0.6 % of the fastest speed: it sticks
    assert law_of("stribeck_friction").degenerate(around, narrow, small(narrow)) is None


@pytest.mark.parametrize("name", ["coulomb_friction", "stribeck_friction", "friction_warmup"])
def test_a_width_may_be_at_either_end(name: str, around: Surroundings) -> None:
    """Friction that truly sticks, and a width that nothing determines; no dry friction is as wide as a force that grows with speed.

    Seen: an eddy current brake was told as Stribeck friction with v_0 at a seventh of the fastest speed.
    """
    (width,) = (p for p in law_of(name).parameters(around) if p.name == "v_0")
    assert width.bounds[1] == 0.1 * around.ranges["speed"].reach
    for end in width.bounds:
        values = {**SOUND[name], "v_0": end, **({"v_s": 15.0} if "v_s" in SOUND[name] else {})}
        assert law_of(name).degenerate(around, values, small(values)) is None


def test_a_stop_may_stand_a_little_beyond_where_a_model_without_it_went(around: Surroundings) -> None:
    """Seen: a pendulum reached 1.561 rad, windows of the model without the stop 1.535, and the stop was refused at its bound."""
    stop = LIBRARY["end_stop"]()
    assert stop.degenerate(around, {"k": 500.0, "where": 5.4, "c": 1.0, "side": 1.0}, {}) is None
    (where,) = (p for p in stop.parameters(around) if p.name == "where")
    assert where.bounds == pytest.approx((-3.8, 5.8))


def test_how_stiff_a_rigid_stop_is_need_not_be_known_where_it_stands_has_to(around: Surroundings) -> None:
    law, values = law_of("end_stop"), SOUND["end_stop"]
    rigid = {**small(values), "k": 2.0 * values["k"]}
    assert law.degenerate(around, values, rigid) is None
    nowhere = {**rigid, "where": 0.1 * around.ranges["position"].span}
    assert "k = " in str(law.degenerate(around, values, nowhere))


@pytest.mark.parametrize(("name", "shape"), [("nonlinear_stiffness", "d_0"), ("nonlinear_damping", "r_0")])
@pytest.mark.parametrize("end", [0, 1])
def test_the_shape_of_a_part_that_is_not_needed_may_sit_at_its_end(name: str, shape: str, end: int, around) -> None:
    """With nothing of that part, where it gives way says nothing of the others."""
    bounds = {p.name: p.bounds for p in law_of(name).parameters(around)}
    values = {**{p.name: 1.0 for p in law_of(name).parameters(around)}, shape: bounds[shape][end]}
    assert np.isfinite(values[shape])
    assert law_of(name).degenerate(around, values, small(values)) is None


@pytest.mark.parametrize("law", [pytest.param(law, id=law.name) for law in (*LIBRARY.values(), *LEARNED.values())])
def test_every_mechanism_answers(law: type[Mechanism], around: Surroundings) -> None:
    mechanism = law("speed") if issubclass(law, Unknown | UnknownWithMemory | UnknownFading) else law()
    values = {p.name: p.value for p in mechanism.parameters(around)}
    amplitudes = {n for probe in mechanism.probes(around) for n in probe.directions} - {SHARE}
    tiny = {
        **values,
        **{n: min(1e-9, p.bounds[1]) for p in mechanism.parameters(around) for n in [p.name] if n in amplitudes},
    }
    answer = mechanism.degenerate(around, tiny, dict.fromkeys(tiny, 1.0) if amplitudes else dict.fromkeys(tiny, np.inf))
    assert answer is not None and "standard deviation" in answer


@pytest.mark.parametrize("name", SOUND)
def test_a_law_whose_amplitudes_are_all_zero_is_none_whatever_is_known_of_them(name: str, around: Surroundings) -> None:
    """Seen: a stop of stiffness 0 and damping 0, told (0.96) beside a backlash."""
    law = law_of(name)
    nothing = {**SOUND[name], **dict.fromkeys(law.essential or law.amplitudes(around), 0.0)}
    assert str(law.degenerate(around, nothing, {})).endswith(" = 0")


def test_a_flow_that_sets_in_over_the_whole_range_has_no_threshold(around: Surroundings) -> None:
    """Seen: what a solar collector loses by the square of its temperature, told as a flow above a threshold (0.97)."""
    width = next(p for p in law_of("threshold_flow").parameters(around) if p.name == "width").bounds[1]
    wide = SOUND["threshold_flow"] | {"width": width, "threshold": 1.5}
    assert (
        law_of("threshold_flow").degenerate(around, wide, small(wide)) == f"width = {width:.3g} is at its upper bound"
    )
    for narrow in (0.0, 0.5 * width):
        values = SOUND["threshold_flow"] | {"width": narrow}
        assert law_of("threshold_flow").degenerate(around, values, small(values)) is None
