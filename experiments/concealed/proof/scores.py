"""Every case scored by the rules of `experiments.concealed.scoring`, and the figures that were promised beforehand.

The rules, fixed before the seal is opened (their hash is on the record):

- detected: the verdict says rightly whether anything is missing. No verdict (a failure, a time-out) is a miss.
- located, named: of the concealed effects, those with a finding at a port that counts, with a name that is accepted.
- spurious: findings that match no concealed effect, as a share of all findings. In a case without effect every finding is.
- closed: the share of the validation error above the floor that the effects remove, for cases with an effect.
- Brier: mean squared difference between the probability of a finding and whether its name is right. Beside it, for people: the same where
  a right finding has the shares of its twins added, as hypotheses that the data cannot tell apart share the probability.
- The shares of moderate and dominant effects are over all cases whose effect is in the library, pairs, excitations and noises included,
  by the visibility that the key gives, not by what was aimed at.
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from experiments.concealed.calibrate import brier
from experiments.concealed.proof.rates import Rate
from experiments.concealed.scoring import Scored, score

LEAST_WITHOUT = 30
"""Cases without an effect that it takes to say that there are no false alarms."""


@dataclass(frozen=True)
class Row:
    """One case: its score (None where the tool gave no verdict), its key, what is on the record, its verdict."""

    name: str
    scored: Scored | None
    key: Mapping[str, Any]
    entry: Mapping[str, Any]
    verdict: Mapping[str, Any] | None

    @property
    def effects(self) -> tuple[str, ...]:
        return tuple(e for e in self.key["effects"] if e != "none")

    @property
    def detected(self) -> bool:
        return self.scored is not None and self.scored.detected

    @property
    def located(self) -> int:
        return self.scored.located if self.scored else 0

    @property
    def named(self) -> int:
        return self.scored.named if self.scored else 0

    @property
    def spurious(self) -> int:
        return self.scored.spurious if self.scored else 0

    @property
    def closed(self) -> float | None:
        return self.scored.closed if self.scored else None

    @property
    def outside(self) -> bool:
        return any(self.key["outside"])

    @property
    def strength(self) -> str:
        return str(self.key["strength"])

    @property
    def cut_short(self) -> bool:
        """Whether the tool says nothing because the time limit stopped it, not because it finds nothing."""
        return self.verdict is not None and not self.verdict["effects"] and self.verdict.get("complete") is False

    @property
    def right(self) -> bool:
        """Whether nothing at all is wrong."""
        return self.detected and self.named == len(self.effects) and self.spurious == 0


def rows(
    answers: Mapping[str, Mapping[str, Any]],
    verdicts: Mapping[str, Mapping[str, Any] | None],
    entries: Mapping[str, Mapping[str, Any]],
) -> list[Row]:
    """All cases, in order."""
    found = []
    for name, key in sorted(answers.items()):
        verdict = verdicts[name]
        scored = score(name, verdict, key) if verdict is not None else None
        found.append(Row(name, scored, key, entries[name], verdict))
    return found


@dataclass(frozen=True)
class Promise:
    """One figure that was promised: what it is, what was measured (text), whether it is kept; None where no case can tell."""

    what: str
    wanted: str
    measured: str
    kept: bool | None


def promises(found: Sequence[Row]) -> list[Promise]:
    """The figures that issue and README promise, in the order in which they are promised."""
    none = [r for r in found if not r.effects]
    strong = [r for r in found if r.effects and not r.outside and r.strength in ("moderate", "dominant")]
    outside = [r for r in found if r.outside]
    effects = sum(len(r.effects) for r in strong)
    findings = [f for r in found if r.scored for f in r.scored.findings]
    closed = [r.closed for r in strong if r.closed is not None]
    claimed, right = np.array([f.probability for f in findings]), np.array([float(f.right) for f in findings])
    alarms = Rate(sum(not r.detected for r in none), len(none))
    spurious = Rate(sum(f.spurious for f in findings), len(findings))
    score_of = brier(claimed, right)
    together = np.array([pair for r in found for pair in _with_twins(r)], float).reshape(-1, 2)
    shared = brier(together[:, 0], together[:, 1])
    middle = statistics.median(closed) if closed else float("nan")
    rates = {
        "detected": (Rate(sum(r.detected for r in strong), len(strong)), 0.99),
        "located": (Rate(sum(r.located for r in strong), effects), 0.95),
        "named": (Rate(sum(r.named for r in strong), effects), 0.90),
    }
    return [
        Promise(
            "false alarms without an effect",
            "0 of at least 30",
            f"{alarms}{_silenced(none)}",
            _alarms_kept(alarms),
        ),
        *(
            Promise(
                f"moderate and dominant effects {what}",
                f"at least {100 * least:.0f} %",
                str(rate),
                _known(strong, rate.share >= least),
            )
            for what, (rate, least) in rates.items()
        ),
        Promise("spurious among all findings", "at most 3 %", str(spurious), _known(findings, spurious.share <= 0.03)),
        _outside_promise(outside),
        Promise(
            "Brier score of the probabilities",
            "at most 0.08",
            f"{score_of:.3f} ({shared:.3f} with the shares of twins added)",
            _known(findings, score_of <= 0.08),
        ),
        Promise("median share of the error closed", "at least 0.95", f"{middle:.3f}", _known(closed, middle >= 0.95)),
    ]


def _outside_promise(outside: Sequence[Row]) -> Promise:
    rate = Rate(sum(r.named == len(r.effects) for r in outside), len(outside))
    return Promise(
        "outside the library: `unknown` at the right port",
        "at least 80 %",
        str(rate),
        _known(outside, rate.share >= 0.8),
    )


def _silenced(none: Sequence[Row]) -> str:
    """Silence that the time limit imposed is no merit: it is told."""
    cut = sum(row.cut_short for row in none)
    return f", {cut} silent only because the time limit stopped the search" if cut else ""


def _alarms_kept(alarms: Rate) -> bool | None:
    """No alarm in too few cases keeps nothing; one alarm breaks it anyway."""
    return False if alarms.hits else True if alarms.cases >= LEAST_WITHOUT else None


def _with_twins(row: Row) -> list[tuple[float, bool]]:
    """Of every finding the probability, to which a right one adds the shares that the verdict gives to its twins; whether it is right."""
    accepted = [list(pair) for pairs in row.key["accept"] for pair in pairs]
    found = []
    for finding, effect in zip(
        row.scored.findings if row.scored else (), (row.verdict or {}).get("effects", ()), strict=True
    ):
        beside = sum(
            float(other["probability"])
            for other in effect.get("alternatives", ())
            if [other["port"], other["mechanism"]] in accepted
        )
        found.append((min(finding.probability + beside * finding.right, 1.0), finding.right))
    return found


def _known(cases: Sequence[Any], kept: bool) -> bool | None:
    return bool(kept) if len(cases) else None
