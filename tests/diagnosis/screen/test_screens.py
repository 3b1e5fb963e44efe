"""The last screen is used again for what it shows, whatever else it shows."""

from __future__ import annotations

from types import SimpleNamespace as Stub

import pytest

from greybox_torch.diagnosis.screen import screens
from greybox_torch.diagnosis.screen.screens import Screens, described
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.unknown import Unknown

MODEL, AROUND = object(), {}


@pytest.fixture
def asked(monkeypatch):
    """What screens are made of, one after another."""
    made = []

    def of(base, accepted, attachments, surroundings, free_names, options):
        made.append([a.prefix for a in attachments])
        probed = tuple((a, None) for a in attachments)
        return Stub(base=base, accepted=tuple(accepted), probed=probed, free_names=tuple(free_names), options=options)

    monkeypatch.setattr(screens, "Screen", Stub(of=of))
    return made


def friction(port: str = "rotor") -> Attachment:
    return Attachment(port, CoulombFriction())


def test_a_screen_of_more_serves_what_is_in_it(asked) -> None:
    kept = Screens()
    whole = kept.showing(MODEL, (), [friction(), Attachment("rotor", TorqueRipple(4.0))], AROUND, ["J"], 1)
    assert kept.showing(MODEL, (), [friction()], AROUND, ["J"], 1) is whole
    assert asked == [["rotor.coulomb_friction", "rotor.torque_ripple"]]


@pytest.mark.parametrize(
    "other",
    [
        {"base": object()},
        {"accepted": (friction("arm"),)},
        {"attachments": [friction("arm")]},
        {"surroundings": {"rotor": None}},
        {"free_names": ["J", "k"]},
        {"options": 2},
    ],
    ids=lambda other: next(iter(other)),
)
def test_another_one_is_made_where_anything_differs(asked, other) -> None:
    how = {
        "base": MODEL,
        "accepted": (),
        "attachments": [friction()],
        "surroundings": AROUND,
        "free_names": ["J"],
        "options": 1,
    }
    kept = Screens()
    first = kept.showing(**how)
    assert kept.showing(**how) is first
    assert kept.showing(**{**how, **other}) is not first and len(asked) == 2


def test_a_law_is_described_by_how_it_was_made() -> None:
    assert described(friction()) == described(friction())
    assert described(Attachment("rotor", TorqueRipple(4.0))) != described(Attachment("rotor", TorqueRipple(5.0)))
    assert described(Attachment("rotor", Unknown("speed", 14))) != described(Attachment("rotor", Unknown("speed", 20)))
    assert described(Attachment("rotor", Unknown("speed"))) == described(Attachment("rotor", Unknown("speed")))
