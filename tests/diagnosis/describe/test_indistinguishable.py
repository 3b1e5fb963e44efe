"""Which rivals of a finding are told together with it."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.describe import indistinguishable
from greybox_torch.diagnosis.describe.indistinguishable import one_of
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.unknown import Unknown

SETTINGS = DiagnosisSettings()


@pytest.fixture
def told(stub, monkeypatch):
    """What is told of the first of some hypotheses: (port, law, share, divergence from the first) each, with ``sizes`` that their first
    parameters have in the step, and ``values`` in the recommended model.
    """

    def fitted(stub, port, law, away, size):
        name = f"{Attachment(port, law).prefix}.F_c"
        parameters = () if size is None else (stub(name=name, unit="N m"),)
        return stub(away=away, values=lambda: {name: size}, model=stub(declared_parameters=parameters))

    def make(*hypotheses, probability=0.6, sizes=(), values=None, one_effect=False, borne_out=1.0):
        ranked = [
            stub(
                candidate=stub(attachment=Attachment(port, law)),
                unknown=isinstance(law, Unknown),
                fitted=fitted(stub, port, law, away, sizes[k] if sizes else None),
            )
            for k, (port, law, _, away) in enumerate(hypotheses)
        ]
        pairs = [(r, h[2]) for r, h in zip(ranked[1:], hypotheses[1:], strict=True)]
        told_shares = {r.candidate.attachment.named: p for r, p in pairs}
        monkeypatch.setattr(indistinguishable, "shares", lambda *given: pairs)
        monkeypatch.setattr(indistinguishable, "told_of", lambda *given: told_shares)
        monkeypatch.setattr(indistinguishable, "divergence", lambda one, other: other.away)
        monkeypatch.setattr(indistinguishable, "one_effect", lambda *given: one_effect)
        ports = [stub(name=name, kind="body") for name in ("motor", "arm")]
        step = SelectionStep((), stub(), tuple(ranked), ranked[0])
        return one_of(stub(all_ports=ports), step, probability, SETTINGS, values=values, borne_out=borne_out)

    return make


def test_outputs_that_differ_by_less_than_could_be_seen(told) -> None:
    found = told(("motor", CoulombFriction(), 0.6, 0.0), ("arm", CoulombFriction(), 0.02, 1.0))
    assert found is not None
    assert found.statement == "dry friction at motor or arm" and found.probability == 0.62
    assert [(m.port, m.mechanism, m.probability) for m in found.members] == [
        ("motor", "coulomb_friction", 0.6),
        ("arm", "coulomb_friction", 0.02),
    ]


def test_who_is_next_to_nothing_counts_in_the_whole_and_is_not_named(told) -> None:
    found = told(
        ("motor", CoulombFriction(), 0.6, 0.0),
        ("arm", CoulombFriction(), 0.3, 1.0),
        ("arm", ConstantBias(), 0.004, 1.0),
    )
    assert found is not None and found.statement == "dry friction at motor or arm"
    assert len(found.members) == 2 and found.probability == pytest.approx(0.904)
    assert told(("motor", CoulombFriction(), 0.9, 0.0), ("arm", CoulombFriction(), 0.004, 0.0)) is None


def test_rivals_are_less_likely_where_nothing_may_be_there(told) -> None:
    both = (("motor", CoulombFriction(), 0.3, 0.0), ("arm", CoulombFriction(), 0.4, 1.0))
    found = told(*both, probability=0.3, borne_out=0.5)
    assert found is not None and [m.probability for m in found.members] == [0.3, 0.2] and found.probability == 0.5


def test_outputs_that_differ_and_evidence_that_is_undecided(told) -> None:
    found = told(("motor", CoulombFriction(), 0.6, 0.0), ("motor", ConstantBias(), 0.3, 40.0))
    assert found is not None and found.statement == "Coulomb friction or constant bias at motor"


def test_a_finding_that_stands_alone(told) -> None:
    assert told(("motor", CoulombFriction(), 0.9, 0.0), ("arm", CoulombFriction(), 0.02, 40.0)) is None
    assert told(("motor", CoulombFriction(), 0.9, 0.0)) is None


def test_a_law_that_contains_the_whole_of_the_one_found_says_the_same(told) -> None:
    assert told(("motor", CoulombFriction(), 0.9, 0.0), ("motor", StribeckFriction(), 0.046, 0.0)) is None
    elsewhere = told(("motor", CoulombFriction(), 0.9, 0.0), ("arm", StribeckFriction(), 0.05, 0.0))
    assert elsewhere is not None
    another = told(("motor", ConstantBias(), 0.5, 0.0), ("motor", CoulombAsymmetry(), 0.4, 0.0))
    assert another is not None and another.statement == "constant bias or Coulomb asymmetry at motor"


def test_a_law_that_contains_the_one_found_and_may_as_well_be_right_is_told_with_it(told) -> None:
    found = told(
        ("motor", CoulombFriction(), 0.49, 0.0), ("motor", PreslidingHysteresis(), 0.45, 9.0), probability=0.49
    )
    assert found is not None and found.statement == "dry friction at motor"
    assert found.probability == pytest.approx(0.94)


def test_curves_are_no_rivals_and_have_none(told) -> None:
    curve = Unknown("speed")
    assert told(("motor", CoulombFriction(), 0.6, 0.0), ("motor", curve, 0.3, 0.0)) is None
    assert told(("motor", curve, 0.6, 0.0), ("motor", CoulombFriction(), 0.3, 0.0)) is None


def test_members_that_are_one_effect_with_the_finding(told) -> None:
    """Seen: an offset of a heater and a constant heat, with an experiment "to tell them apart"."""
    both = (("motor", ConstantBias(), 0.6, 0.0), ("arm", ConstantBias(), 0.3, 1.0))
    found = told(*both, one_effect=True)
    assert found is not None and [m.one_effect for m in found.members] == [False, True]
    assert found.one_effect == found.members and not found.separable
    apart = told(*both)
    assert apart is not None and apart.one_effect == () and apart.separable


def test_no_more_is_claimed_than_the_most_that_ever_is(told) -> None:
    found = told(("motor", CoulombFriction(), 0.6, 0.0), ("arm", CoulombFriction(), 0.6, 0.0))
    assert found is not None and found.probability == SETTINGS.highest_probability


def test_the_size_is_that_of_the_recommended_model(told) -> None:
    pair = (("motor", CoulombFriction(), 0.5, 0.0), ("arm", CoulombFriction(), 0.5, 0.0))
    before = told(*pair, probability=0.5, sizes=(0.002, 0.003))
    assert before is not None and before.statement == "dry friction of about 0.0025 N m at motor or arm"
    found = told(*pair, probability=0.5, sizes=(0.002, 0.003), values={"motor.coulomb_friction.F_c": 0.004})
    assert found is not None and found.statement == "dry friction of about 0.005 N m at motor or arm"
    gone = told(*pair, sizes=(0.002, 0.003), values={"motor.coulomb_friction.F_c": 0.0})
    assert gone is not None and gone.statement == "dry friction at motor or arm"
