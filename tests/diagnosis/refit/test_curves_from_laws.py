"""A free curve comes at least as far as a law that it contains."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.hypothesis.fit import hypothesis
from greybox_torch.diagnosis.refit import curves_from_laws as module
from greybox_torch.diagnosis.refit.curves_from_laws import curves_from_laws
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import QuadraticDrag
from greybox_torch.mechanisms.unknown import Unknown


@pytest.fixture(scope="module")
def refits(motor_data, motor, begun):
    """The search on a motor with a drag, and a law or a curve with the amplitudes that it is given, as a refit."""
    search = begun(motor_data(torque=lambda q, v: -0.004 * v * abs(v)), motor)

    def refit(effect: Attachment, **values: float) -> RankedCandidate:
        start = search.plain.values() | {f"{effect.prefix}.{n}": v for n, v in values.items()}
        frozen = frozenset(n for n in start if n.startswith(effect.prefix))
        options = search.study.options
        fitted = hypothesis(search.problem, (effect,), search.surroundings, [start], options=options, frozen=frozen)
        assert fitted is not None
        return judged(Candidate(effect, (), 0.5), search.plain, fitted, search.study.settings)

    return search, refit


def test_a_curve_begins_anew_from_a_law_that_goes_farther_and_is_not_told(motor, refits, monkeypatch) -> None:
    """Seen: a pad that pushes and does not pull, 90 % by the curve and 99.4 % by a wave, and a stiffness told beside the curve (0.97)."""
    search, refit = refits
    law = refit(attach(motor, "rotor", QuadraticDrag()), c=0.004)
    stuck = refit(attach(motor, "rotor", Unknown("speed", 12)), **{f"w_{k}": 0.0 for k in range(12)})
    assert stuck.gain < 0.1 < law.gain
    assert curves_from_laws(search.study, search.plain, [law, stuck]) == [law, stuck], "the law is told itself"
    monkeypatch.setattr(module, "sound", lambda study, ranked: False)
    same, anew = curves_from_laws(search.study, search.plain, [law, stuck])
    assert same is law
    assert anew.gain > law.gain - 0.05 and anew.fitted.effects == stuck.fitted.effects
    assert anew.candidate is stuck.candidate


@pytest.mark.parametrize(
    ("curve", "law"),
    [
        (("rotor", Unknown("position", 12)), ("rotor", QuadraticDrag(), {"c": 0.004})),
        (("rotor", Unknown("speed", 12, "position")), ("rotor", QuadraticDrag(), {"c": 0.004})),
        (("rotor", Unknown("speed", 12)), ("rotor", ConstantBias(), {"c": 0.0})),
    ],
    ids=["of another signal", "what another signal is multiplied by", "not as far"],
)
def test_else_it_stays_as_it_was(motor, refits, monkeypatch, curve, law) -> None:
    monkeypatch.setattr(module, "sound", lambda study, ranked: False)
    search, refit = refits
    port, mechanism, values = law
    stuck = refit(attach(motor, *curve), **{f"w_{k}": 0.0 for k in range(12)})
    both = [refit(attach(motor, port, mechanism), **values), stuck]
    assert curves_from_laws(search.study, search.plain, both) == both
