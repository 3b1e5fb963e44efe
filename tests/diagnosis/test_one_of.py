"""What recordings do not tell apart, by how likely the members are."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.one_of import Alternative, OneOf, spoken_at

LAG, INPUT, DELAY = ("sensor", "sensor_lag"), ("actuator", "input_lag"), ("actuator", "input_delay")


@pytest.mark.parametrize(
    ("members", "told", "in_brief"),
    [
        (
            {LAG: 0.61, INPUT: 0.36},
            "these recordings do not tell apart: sensor lag at sensor (0.61), input lag at actuator (0.36)",
            "These recordings do not tell 2 laws apart.",
        ),
        (
            {LAG: 0.85, INPUT: 0.02},
            "by far the likeliest is sensor lag at sensor (0.85); these recordings do not rule out input lag at actuator (0.02)",
            "One law is by far the likeliest; these recordings do not rule out 1 other.",
        ),
        (
            {LAG: 0.5, INPUT: 0.3, DELAY: 0.02},
            "these recordings do not tell apart: sensor lag at sensor (0.50), input lag at actuator (0.30); less likely, and not ruled "
            "out: input delay at actuator (0.02)",
            "These recordings do not tell 2 laws apart, and do not rule out 1 more.",
        ),
    ],
)
def test_members_of_unequal_share_are_not_told_as_undecided(members, told, in_brief) -> None:
    """Seen: "do not tell apart: sensor lag (0.85), input lag (0.02)"."""
    found = OneOf(
        "some time passes", 0.87, tuple(Alternative(port, law, share) for (port, law), share in members.items())
    )
    assert found.told == told and found.in_brief == in_brief


def test_an_input_that_saturates_is_called_by_what_it_is() -> None:
    """Seen: "torque saturation at actuator.inflow", for a flow."""
    assert spoken_at("torque_saturation", "actuator.inflow") == "input saturation at actuator.inflow"
