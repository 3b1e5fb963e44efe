"""Effects that are small beside another one, and remove nearly all that this leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import standing
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.standing import refinements
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction


def a_small_one_beside_a_large_one(stub, at: str, port: str, **hypotheses) -> tuple:
    """The prefixes of friction at ``at`` and of a constant force at ``port``, and a state with both."""
    effects = (Attachment(at, CoulombFriction()), Attachment(port, ConstantBias()))
    large, small = (e.prefix for e in effects)
    return large, small, stub(effects=effects, prefixes={large, small}, **hypotheses)


@pytest.mark.parametrize(
    ("port", "of_the_rest", "size_of_it", "told"),
    [
        ("sensor", 0.92, 0.0104, True),
        ("sensor", 0.6, 0.0104, False),
        ("arm", 0.92, 0.0104, False),
        ("sensor", 0.92, 0.002, False),
    ],
    ids=["nearly all of the rest", "a part of the rest", "at one port", "next to nothing"],
)
def test_what_removes_nearly_all_that_the_others_leave_elsewhere_is_no_part_of_what_they_lack(
    dead_zone_search, stub, port, of_the_rest, size_of_it, told
) -> None:
    """Seen: a gyro that shows 8 % too little, 1 % of the mismatch beside uneven friction with 21 times the noise left: a refinement."""
    plain = dead_zone_search.plain
    large, small, state = a_small_one_beside_a_large_one(stub, "arm", port, plain=plain, current=plain)
    others = stub(times_noise=lambda hypothesis: np.array([21.0]), fits=lambda hypothesis: ())
    gains = {large: Gain(0.99, 1e-3, size=0.9), small: Gain(of_the_rest, 0.01, size=size_of_it)}
    some = refinements(dead_zone_search.study, state, others, gains, {large: 0.9, small: size_of_it})
    assert some == (set() if told else {small})


@pytest.mark.parametrize(
    ("port", "of_the_rest", "left", "told"),
    [
        ("tendon", 0.994, 1.1, True),
        ("tendon", 0.97, 1.1, False),
        ("hand", 0.994, 1.1, False),
        ("tendon", 0.994, 3.0, False),
    ],
    ids=["all of the rest", "not quite", "at one port", "more than noise is left"],
)
def test_what_removes_all_that_the_others_leave_is_a_finding_however_small_it_is(
    monkeypatch, dead_zone_search, stub, port, of_the_rest, left, told
) -> None:
    """Seen: a wrist's slack tendon, 0.16 % of the mismatch beside the hand's weight and 13 times the noise, told as a refinement."""
    monkeypatch.setattr(standing, "_most_is_left", lambda *_: False)
    plain, current = dead_zone_search.plain, replace(dead_zone_search.plain)
    large, small, state = a_small_one_beside_a_large_one(stub, "hand", port, plain=plain, current=current)
    others = stub(times_noise=lambda h: np.array([left if h is current else 400.0]), fits=lambda h: h.fits)
    gains = {large: Gain(0.999, 1e-3, size=0.99), small: Gain(of_the_rest, 1e-3, size=0.0016)}
    found = refinements(dead_zone_search.study, state, others, gains, {large: 0.99, small: 0.0016})
    assert found == (set() if told else {small})
