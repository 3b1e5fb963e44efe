"""The figures that were promised beforehand, over the cases of a proof.

The rules, fixed before the seal is opened (their hash is on the record), beside those of `experiments.verdicts.scoring`:

- The shares of strong effects (moderate, dominant, overwhelming) are over all cases whose effect is in the library, pairs, excitations and
  noises included, by the visibility that the key gives, not by what was aimed at.
- spurious: as a share of all findings.
- Brier: mean squared difference between the probability of a finding and whether its name is right. Beside it, for people: that of the
  answers, of which names that the key accepts are one (`experiments.verdicts.answers`), and that of the classes, of hypotheses that the
  data cannot tell apart.
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from experiments.verdicts.rates import Rate
from experiments.verdicts.scoring import Scored, score
from experiments.verdicts.totals import brier_of, brier_of_answers, brier_of_classes

LEAST_WITHOUT = 45
"""Cases without an effect that it takes to say that there are no false alarms."""
STRONG = ("moderate", "dominant", "overwhelming")


@dataclass(frozen=True)
class Promise:
    """One figure that was promised: what it is, what was measured (text), whether it is kept; None where no case can tell."""

    what: str
    wanted: str
    measured: str
    kept: bool | None


def scored_cases(
    answers: Mapping[str, Mapping[str, Any]],
    verdicts: Mapping[str, Mapping[str, Any] | None],
    entries: Mapping[str, Mapping[str, Any]],
) -> list[Scored]:
    """All cases, in order. `entries`: what is on the record of each."""
    return [
        score(
            name,
            verdicts[name],
            key,
            said="" if verdicts[name] is not None else entries[name]["said"],
            seconds=entries[name]["seconds"],
        )
        for name, key in sorted(answers.items())
    ]


def promises(found: Sequence[Scored]) -> list[Promise]:
    """The figures that are promised, in the order in which they are promised."""
    strong = [s for s in found if s.effects and not s.outside and s.strength in STRONG]
    outside = [s for s in found if s.outside]
    return [
        _alarms([s for s in found if not s.effects]),
        *_shares(strong),
        _spurious("spurious among all findings", found, 0.02),
        _spurious(
            "spurious among findings on overwhelming effects", [s for s in found if s.strength == STRONG[-1]], 0.03
        ),
        _at_least(
            "outside the library: `unknown` at the right port",
            Rate(sum(s.named == len(s.effects) for s in outside), len(outside)),
            0.9,
        ),
        _brier(found),
        _closed(strong),
        _none("cases without a verdict", found, [s.name for s in found if s.verdict is None]),
        _none("validation worse than the re-estimated model's", found, [s.name for s in found if s.worse]),
        _none("verdicts that contradict themselves", found, [s.name for s in found if s.contradictions]),
    ]


def _alarms(none: Sequence[Scored]) -> Promise:
    """No alarm in too few cases keeps nothing; one alarm breaks it anyway. Silence that the time limit imposed is no merit: it is told."""
    alarms = Rate(sum(not s.detected for s in none), len(none))
    cut = sum(s.cut_short for s in none)
    silenced = f", {cut} silent only because the time limit stopped the search" if cut else ""
    kept = False if alarms.hits else True if alarms.cases >= LEAST_WITHOUT else None
    return Promise("false alarms without an effect", f"0 of at least {LEAST_WITHOUT}", f"{alarms}{silenced}", kept)


def _shares(strong: Sequence[Scored]) -> list[Promise]:
    effects = sum(len(s.effects) for s in strong)
    rates = (
        ("detected", Rate(sum(s.detected for s in strong), len(strong)), 0.99),
        ("located", Rate(sum(s.located for s in strong), effects), 0.97),
        ("named", Rate(sum(s.named for s in strong), effects), 0.95),
    )
    return [_at_least(f"moderate and stronger effects {what}", rate, least) for what, rate, least in rates]


def _at_least(what: str, rate: Rate, least: float) -> Promise:
    return Promise(what, f"at least {100 * least:.0f} %", str(rate), rate.share >= least if rate.cases else None)


def _spurious(what: str, found: Sequence[Scored], most: float) -> Promise:
    findings = [f for s in found for f in s.findings]
    rate = Rate(sum(f.spurious for f in findings), len(findings))
    return Promise(what, f"at most {100 * most:.0f} %", str(rate), rate.share <= most if findings else None)


def _brier(found: Sequence[Scored]) -> Promise:
    findings = [f for s in found for f in s.findings]
    others = f"{brier_of_answers(findings):.3f} of the answers, {brier_of_classes(findings):.3f} of the classes"
    measured = f"{brier_of(findings):.3f} ({others})"
    return Promise(
        "Brier score of the probabilities", "at most 0.05", measured, brier_of(findings) <= 0.05 if findings else None
    )


def _closed(strong: Sequence[Scored]) -> Promise:
    closed = [s.closed for s in strong if s.closed is not None]
    middle = statistics.median(closed) if closed else float("nan")
    return Promise(
        "median share of the error closed", "at least 0.97", f"{middle:.3f}", middle >= 0.97 if closed else None
    )


def _none(what: str, found: Sequence[Scored], names: Sequence[str]) -> Promise:
    return Promise(what, "0", ", ".join([str(len(names)), *names]), not names if found else None)
