"""The last screen is used again for what it shows, whatever else it shows."""

from __future__ import annotations

from types import SimpleNamespace as Stub
from typing import Any

import pytest

from greybox_torch.diagnosis.screen.screens import Screens, described
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.unknown import Unknown

STUDY, HYPOTHESIS = object(), object()


def friction(port: str = "rotor") -> Attachment:
    return Attachment(port, CoulombFriction())


def screen_of(*attachments: Attachment) -> Any:
    return Stub(probed=tuple((a, None) for a in attachments))


def test_a_screen_of_more_serves_what_is_in_it() -> None:
    kept, more = Screens(), [friction(), Attachment("rotor", TorqueRipple(4.0))]
    whole = kept.showing(more, lambda: screen_of(*more), STUDY, HYPOTHESIS)
    assert kept.showing([friction()], lambda: pytest.fail("it is there"), STUDY, HYPOTHESIS) is whole


@pytest.mark.parametrize(
    ("attachments", "beside"),
    [
        ([friction("arm")], (STUDY, HYPOTHESIS)),
        ([friction(), friction("arm")], (STUDY, HYPOTHESIS)),
        ([friction()], (object(), HYPOTHESIS)),
        ([friction()], (STUDY, object())),
        ([friction()], ()),
    ],
)
def test_another_one_is_made_where_anything_differs(attachments: list[Attachment], beside: tuple[object, ...]) -> None:
    kept, first, other = Screens(), screen_of(friction()), screen_of(*attachments)
    assert kept.showing([friction()], lambda: first, STUDY, HYPOTHESIS) is first
    assert kept.showing([friction()], lambda: other, STUDY, HYPOTHESIS) is first
    assert kept.showing(attachments, lambda: other, *beside) is other
    assert kept.showing(attachments, lambda: first, *beside) is other


def test_a_law_is_described_by_how_it_was_made() -> None:
    assert described(friction()) == described(friction())
    assert described(Attachment("rotor", TorqueRipple(4.0))) != described(Attachment("rotor", TorqueRipple(5.0)))
    assert described(Attachment("rotor", Unknown("speed", 14))) != described(Attachment("rotor", Unknown("speed", 20)))
    assert described(Attachment("rotor", Unknown("speed"))) == described(Attachment("rotor", Unknown("speed")))
