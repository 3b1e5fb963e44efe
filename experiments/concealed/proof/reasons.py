"""Why a case was missed, as far as its key and its verdict tell. Facts, in words; the judgement is left to the reader."""

from __future__ import annotations

from experiments.concealed.visibility import MODERATE
from experiments.verdicts.scoring import Scored

NOT_SHOWN = 1.5
"""Times the floor below which the refitted model's error in the estimation experiment shows nothing."""


def reasons(row: Scored) -> list[str]:
    """Sentences on what went wrong in a case that is not right; empty where nothing did."""
    if row.right:
        return []
    if row.verdict is None:
        return [f"no verdict: {row.said}"]
    found = [*_strength(row), *_answers(row), *_alternatives(row)]
    if row.verdict.get("complete") is False:
        found.append("the search was stopped by the time limit")
    return found


def _strength(row: Scored) -> list[str]:
    if not row.effects:
        return []
    found = []
    if row.key["visibility"] < MODERATE:
        found.append(
            f"weak: {row.key['visibility']:.1f} times the floor at most, for whoever refits all four experiments"
        )
    for effect, added in zip(row.effects, row.key.get("beside", ()), strict=False):
        if added < MODERATE:
            found.append(
                f"{effect} adds {added:.1f} times the floor beside the other, however strong the machine allows"
            )
    ratio = _estimation_ratio(row)
    if ratio is not None and ratio < NOT_SHOWN:
        found.append(
            f"the experiment to choose with hardly shows it: the refitted model leaves {ratio:.1f} times the floor there"
        )
    return found


def _answers(row: Scored) -> list[str]:
    assert row.verdict is not None
    found = []
    if not row.findings:
        found.append("found missing, but not what" if row.verdict["mismatch"] else "nothing was found")
    for finding in row.findings:
        answer = f"{finding.mechanism} at {finding.port}"
        if finding.spurious:
            found.append(f"{answer} is spurious")
        elif not finding.right:
            place = "the place is right" if finding.located else "the place is wrong too"
            near = [finding.port, finding.mechanism] in [pair for pairs in row.key["near"] for pair in pairs]
            found.append(f"{answer} is {'a near miss' if near else 'the wrong name'}; {place}")
    missing = len(row.effects) - sum(f.right or f.located for f in row.findings if not f.spurious)
    if row.findings and missing > 0:
        found.append(f"{missing} of {len(row.effects)} effects without a finding")
    return found


def _alternatives(row: Scored) -> list[str]:
    """Right answers that the verdict held possible."""
    assert row.verdict is not None
    accepted = [pair for pairs in row.key["accept"] for pair in pairs]
    return [
        f"{other['mechanism']} at {other['port']} was held possible ({other['probability']:.2f})"
        for effect in row.verdict["effects"]
        if [effect["port"], effect["mechanism"]] not in accepted
        for other in effect.get("alternatives", [])
        if [other["port"], other["mechanism"]] in accepted
    ][:1]


def _estimation_ratio(row: Scored) -> float | None:
    """Error of the refitted plain model in the estimation experiment, in units of the floor; the larger of several outputs'."""
    assert row.verdict is not None
    sigma = row.key["sigma"]
    ratios = [
        float(fit["refit"]["rmse"]) / float(sigma[fit["output"]] if isinstance(sigma, dict) else sigma)
        for fit in row.verdict["fit"]
        if fit["role"] == "estimation"
    ]
    return max(ratios) if ratios else None
