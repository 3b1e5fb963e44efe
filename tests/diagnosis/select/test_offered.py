"""What is offered to join a hypothesis."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.progress import Journal
from greybox_torch.diagnosis.select import offered as module
from greybox_torch.diagnosis.select.offered import from_motion, screen_scores
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body


def test_the_measured_motion_is_not_asked_beside_a_free_curve(stub) -> None:
    """Seen: 74 s for the heights of one curve, which the equations would have had to estimate anew."""
    assert from_motion(stub(), stub(has_curve=True)) == []


@pytest.mark.parametrize(
    ("coarse", "fine", "effects", "there"),
    [
        (0.66, 0.97, (), True),
        (0.66, 0.80, (), False),
        (0.95, 0.99, (), False),
        (0.66, 0.97, ("a law",), False),
    ],
    ids=["far better", "little better", "the coarse one is enough", "beside a law"],
)
def test_fine_curves_along_the_way_stand_beside_the_coarse_ones_where_nothing_explains_nearly_all(
    monkeypatch, stub, coarse, fine, effects, there
) -> None:
    """Seen: two dips of a rail, a thirtieth of the way long, told as nothing. Beside laws, which are never exact, forty knots always take
    up something: a gripper's friction was told with crumbs beside it.
    """

    def curve(signal: str, knots: int, factor: str = "") -> object:
        return stub(port="cart", label="", mechanism=Unknown(signal, knots, factor))

    offered = {
        "coarse": [curve("position", 14)],
        "fine": [curve("position", 40), curve("speed", 40), curve("position", 40, "speed")],
    }
    explained = {14: coarse, 40: fine}

    def scored(study, state, every, fits) -> tuple:
        return (tuple(stub(attachment=a, explained=explained[a.mechanism.knots]) for a in every),)

    monkeypatch.setattr(module, "offer_all", lambda *args, **options: None)
    monkeypatch.setattr(module, "_offered", lambda *args: offered["coarse"])
    monkeypatch.setattr(module, "_fine_curves", lambda study: offered["fine"])
    monkeypatch.setattr(module, "_scored", scored)
    monkeypatch.setattr(module, "curves_over_parts", lambda study, effects, fits: ((),))
    model = stub(ports=(Body("cart", speed="v", position="q"),))
    study = stub(
        settings=DiagnosisSettings(), problem=stub(model=model), working_on=lambda text: None, journal=Journal()
    )
    (found,) = screen_scores(study, stub(effects=effects, current=stub(fits=())), curves=True, fine=False)
    assert [s.attachment for s in found] == [*offered["coarse"], *offered["fine"][: int(there)]]
