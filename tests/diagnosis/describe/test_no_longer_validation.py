"""Which validation experiments judge no longer, in sentences."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from greybox_torch.diagnosis.describe.report_data import no_longer_validation

CHOSEN = "was taken to choose with as well (the evidence says why)."


def experiments(stub, roles: Mapping[str, str]):
    """A data set of experiments with these roles."""
    rows = [stub(name=name, role=role) for name, role in roles.items()]

    def of(role: str):
        return lambda: [r for r in rows if r.role == role]

    return stub(validation=of("validation"), estimation=of("estimation"))


@pytest.mark.parametrize(
    ("given", "used", "told"),
    [
        ({"Sweep": "validation"}, {"Sweep": "validation"}, ()),
        (
            {"Sweep": "validation", "Steps": "validation"},
            {"Sweep": "estimation", "Steps": "validation"},
            (f"Sweep no longer counts as validation: it {CHOSEN}",),
        ),
        (
            {"Sweep": "validation"},
            {"Sweep": "estimation", "Sweep from 4 s": "validation"},
            (f"Of Sweep only Sweep from 4 s counts as validation: its beginning {CHOSEN}",),
        ),
        (
            {"Sweep": "validation", "Sweep from rest": "validation"},
            {"Sweep": "estimation", "Sweep from rest": "validation"},
            (f"Sweep no longer counts as validation: it {CHOSEN}",),
        ),
    ],
    ids=["none", "a whole one", "a beginning", "another experiment whose name begins alike"],
)
def test_what_judges_no_longer(stub, given, used, told) -> None:
    assert no_longer_validation(experiments(stub, given), experiments(stub, used)) == told
