"""What a verdict is worth against the key of its case.

A key lists, for every concealed effect, the answers (port, mechanism) that are right (``accept``), those that are nearly right
(``near``), and the ports where a finding counts as located (``ports``). The rules:

- detected: the verdict says rightly whether anything is missing. No verdict is a miss.
- Findings are taken in the verdict's order, its headline first. Each takes the first effect, not taken yet, of which it is a right answer;
  else a near one; else one at whose ports it stands. What takes none is spurious; where nothing is concealed every finding is.
- closed: the share of the validation error (RMS above the noise floor) that the recommended model removes, where something is concealed.
- A class (``one_of``) is right where any of its members is. Refinements count neither way.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.verdicts.answers import Claim, claims
from experiments.verdicts.running import RUN, VERDICT, has_verdict, sentence
from greybox_torch.diagnosis import contradictions, worse_than_refit

KINDS = ("without effect", "one effect", "two effects or more")
OUTSIDE = "outside the library"
COMPLETE = "complete.toml"
NOTHING_CONCEALED = {"effects": ["none"], "accept": [[]], "near": [[]], "ports": [[]], "sigma": 0.0}
STEPS = (("accept", True), ("near", False), ("ports", False))
"""What a finding is looked up in, one after the other, and whether a hit there makes it right."""


@dataclass(frozen=True)
class Finding:
    """One effect of a verdict: what it said, with which probability, and whether it is right, at the right place, or neither.

    ``exact`` says whether it is the name of what was concealed itself, and not of a look-alike that the key takes as well (``own`` of the
    key; as ``right`` where that does not say). ``class_probability`` and ``class_right`` are those of the whole class (``one_of``), its
    own where it has none; ``answers`` what it claims of each answer, of which names that the key accepts are one.
    """

    port: str
    mechanism: str
    probability: float
    right: bool
    exact: bool
    located: bool
    spurious: bool
    class_probability: float
    class_right: bool
    answers: tuple[Claim, ...]


@dataclass(frozen=True)
class Scored:
    """A case: its key, its verdict (None where there is none), what that said in a few words, its findings, and how long it took in s.

    ``closed`` is the share of the root mean square validation error above the noise that the effects remove; None where nothing is
    concealed, and without a verdict.
    """

    name: str
    key: Mapping[str, Any]
    verdict: Mapping[str, Any] | None
    said: str
    seconds: float
    findings: tuple[Finding, ...] = ()
    closed: float | None = None

    @property
    def effects(self) -> tuple[str, ...]:
        """What is concealed."""
        return tuple(e for e in self.key["effects"] if e != "none")

    @property
    def detected(self) -> bool:
        return self.verdict is not None and self.verdict["mismatch"] == bool(self.effects)

    @property
    def named(self) -> int:
        return sum(f.right for f in self.findings)

    @property
    def located(self) -> int:
        return sum(f.located for f in self.findings)

    @property
    def spurious(self) -> int:
        return sum(f.spurious for f in self.findings)

    @property
    def outside(self) -> bool:
        """Whether the effect is none of the library's: the right answer is ``unknown``, at the right place."""
        return any(self.key.get("outside", ()))

    @property
    def kind(self) -> str:
        return OUTSIDE if self.outside else KINDS[min(len(self.effects), 2)]

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

    @property
    def contradictions(self) -> list[str]:
        return contradictions(self.verdict) if self.verdict is not None else []

    @property
    def worse(self) -> bool:
        """Whether the recommended model simulates the validation experiments worse than the re-estimated one, all of them counted."""
        return self.verdict is not None and worse_than_refit(self.verdict["fit"])


def score(
    name: str,
    verdict: Mapping[str, Any] | None,
    key: Mapping[str, Any],
    *,
    said: str = "",
    seconds: float | None = None,
) -> Scored:
    """Score one verdict. `said` and `seconds`: where they do not follow from the verdict, or there is none."""
    if verdict is None:
        return Scored(name, key, None, said or "no verdict", float("nan") if seconds is None else seconds)
    concealed = [e for e in key["effects"] if e != "none"]
    return Scored(
        name,
        key,
        verdict,
        said or sentence(verdict),
        float(verdict.get("seconds", float("nan"))) if seconds is None else seconds,
        _findings(verdict["effects"], key if concealed else {name: () for name, _ in STEPS}),
        _closed(verdict, key) if concealed else None,
    )


def score_all(cases: Path, verdicts: Path) -> list[Scored]:
    """Every case of a folder that has a key: CASES/**/key.json, by the name of its folder, against VERDICTS/NAME/verdict.json.

    Where `complete.toml` lies beside the key, its model leaves out nothing that is known: a case of its own, with nothing concealed.
    """
    found = []
    for file in sorted(cases.rglob("key.json")):
        name = file.parent.name
        found.append(_scored(name, verdicts, _read(file)))
        if (file.parent / COMPLETE).is_file():
            found.append(_scored(f"{name}_complete", verdicts, NOTHING_CONCEALED))
    return found


def _scored(name: str, verdicts: Path, key: Mapping[str, Any]) -> Scored:
    answer = verdicts / name
    verdict = _read(answer / VERDICT) if has_verdict(answer) else None
    run = _read(answer / RUN) if (answer / RUN).is_file() else {}
    return score(name, verdict, key, said="" if verdict else run.get("failure", ""), seconds=run.get("seconds"))


def _read(file: Path) -> dict[str, Any]:
    return json.loads(file.read_text(encoding="utf-8"))


def _findings(effects: Sequence[Mapping[str, Any]], key: Mapping[str, Any]) -> tuple[Finding, ...]:
    left = set(range(len(key["accept"])))
    found = []
    for effect in effects:
        hit, right = _taken(effect, key, left)
        left.discard(hit)
        whole = effect.get("one_of") or {}
        members = [effect, *whole.get("members", ())]
        found.append(
            Finding(
                effect["port"],
                effect["mechanism"],
                float(effect["probability"]),
                right=right,
                exact=right and _among(effect, [key["own"][hit]] if "own" in key else key["accept"][hit]),
                located=hit >= 0 and effect["port"] in key["ports"][hit],
                spurious=hit < 0,
                class_probability=float(whole.get("probability", effect["probability"])),
                class_right=any(_among(member, answers) for member in members for answers in key["accept"]),
                answers=claims(effect, {(port, name) for port, name in key["accept"][hit]} if hit >= 0 else ()),
            )
        )
    return tuple(found)


def _taken(effect: Mapping[str, Any], key: Mapping[str, Any], left: set[int]) -> tuple[int, bool]:
    """The concealed effect that a finding takes (-1: none), and whether its name is right."""
    for table, right in STEPS:
        for i in sorted(left):
            if effect["port"] in key["ports"][i] if table == "ports" else _among(effect, key[table][i]):
                return i, right
    return -1, False


def _among(effect: Mapping[str, Any], answers: Sequence[Sequence[str]]) -> bool:
    return [effect["port"], effect["mechanism"]] in [list(answer) for answer in answers]


def _closed(verdict: Mapping[str, Any], key: Mapping[str, Any]) -> float:
    """With several outputs ``sigma`` may give each its own noise, in units of which their errors are added."""
    sigma = key["sigma"]
    left = {"refit": 0.0, "augmented": 0.0}
    for row in verdict["fit"]:
        if row["role"] == "validation":
            floor, unit = (sigma[row["output"]],) * 2 if isinstance(sigma, Mapping) else (sigma, 1.0)
            for stage in left:
                rmse = row[stage]["rmse"]
                error = math.inf if rmse is None else float(rmse)  # null: a free run that overflowed
                left[stage] += max(error**2 - floor**2, 0.0) / unit**2
    if math.isinf(left["refit"]):
        return 0.0 if math.isinf(left["augmented"]) else 1.0
    return 1.0 - (left["augmented"] / left["refit"]) ** 0.5 if left["refit"] > 0 else 0.0
