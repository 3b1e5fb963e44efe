"""Front runners are compared from the same start, and with their parent from there."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.select import compare as module
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget


@pytest.fixture
def fits(stub, monkeypatch):
    """Hypotheses that are the better the nearer to 2 the parameter J was begun, and a little more so for an asymmetry."""

    def fitted(name: str, inertia: float, *, free: bool = False) -> Any:
        effects = (stub(prefix=name, mechanism=stub(free=free)),) if name else ()
        score = abs(inertia - 2.0) - 0.1 * (name == "asymmetry")
        own = {f"{name}.size": 1.0} if name else {}
        return stub(effects=effects, score=score, values=lambda: {"J": inertia, **own}, problem=stub(names=["J"]))

    polished: list[tuple[str, list[dict[str, float]]]] = []

    beside: list[Any] = []

    def polish(study: Any, one: Any, starts: list[dict[str, float]], there: Any = None) -> Any:
        name = one.effects[0].prefix if one.effects else ""
        polished.append((name, starts))
        beside.append((name, there))
        return min([one, *(fitted(name, s["J"]) for s in starts)], key=lambda h: h.score)

    def judged(candidate: Any, parent: Any, one: Any, settings: Any) -> Any:
        return stub(candidate=candidate, fitted=one, gain=parent.score - one.score)

    monkeypatch.setattr(module, "_polished", polish)
    monkeypatch.setattr(module, "restarts", lambda study, screened, ranked: [])
    monkeypatch.setattr(module, "judged", judged)
    monkeypatch.setattr(module, "curves_from_laws", lambda study, parent, ranked: ranked)
    monkeypatch.setattr(module, "in_order", lambda ranked, settings: sorted(ranked, key=lambda r: r.fitted.score))
    return stub(fitted=fitted, polished=polished, beside=beside)


def test_rivals_are_refitted_from_where_the_best_one_has_the_models_parameters(stub, fits) -> None:
    """Seen: an input bias (0.97, no rival) that a curve had led to the optimum; the asymmetry that was there stood beside it."""
    study: Any = stub(settings=DiagnosisSettings(), budget=SearchBudget(), card={"J": 1.0})
    bias, asymmetry, curve = (
        fits.fitted("bias", 2.0),
        fits.fitted("asymmetry", 2.2),
        fits.fitted("curve", 2.3, free=True),
    )
    ranked = [
        stub(candidate=h.effects[0].prefix, fitted=h, gain=1.0, unknown=h is curve) for h in (bias, asymmetry, curve)
    ]
    compared = module.compare(study, fits.fitted("", 3.0), (), ranked)
    assert [r.candidate for r in compared.ranked] == ["asymmetry", "bias", "curve"]
    assert compared.ranked[0].fitted.values() == {"J": 2.0, "asymmetry.size": 1.0}
    assert compared.ranked[2].fitted is curve
    assert compared.parent.values() == {"J": 2.0}
    (parent_beside,) = (there for name, there in fits.beside if name == "")
    assert parent_beside is compared.ranked[0].fitted, "with the start states of the best one too"


def test_what_gains_nothing_is_compared_as_it_is(stub, fits) -> None:
    study: Any = stub(settings=DiagnosisSettings(), budget=SearchBudget(), card={})
    parent, none = fits.fitted("", 3.0), stub(candidate="bias", fitted=None, gain=0.0)
    assert module.compare(study, parent, (), [none]) == module.Comparison(parent, (none,))
    assert fits.polished == []


def test_a_parent_that_has_got_ahead_is_where_its_front_runners_begin_anew(stub, fits, monkeypatch) -> None:
    """Seen: an arm's uneven friction, of which nothing was said: refitted, the model without it had found a better optimum in which the
    friction would have been 13 % better still, and each law was compared with that from the worse one.
    """
    study: Any = stub(settings=DiagnosisSettings(), budget=SearchBudget(), card={"J": 1.0})
    bias, asymmetry = fits.fitted("bias", 2.6), fits.fitted("asymmetry", 2.7)
    ranked = [stub(candidate=h.effects[0].prefix, fitted=h, gain=1.0, unknown=False) for h in (bias, asymmetry)]
    polish = module._polished

    def led_elsewhere(study: Any, one: Any, starts: list[dict[str, float]], there: Any = None) -> Any:
        return polish(study, one, [*starts, {"J": 2.0}] if not one.effects else starts, there)

    monkeypatch.setattr(module, "_polished", led_elsewhere)
    compared = module.compare(study, fits.fitted("", 3.0), (), ranked)
    assert compared.parent.values() == {"J": 2.0}
    assert [r.candidate for r in compared.ranked] == ["asymmetry", "bias"]
    assert compared.ranked[0].fitted.values() == {"J": 2.0, "asymmetry.size": 1.0}
    assert [round(r.gain, 9) for r in compared.ranked] == [0.1, 0.0]
