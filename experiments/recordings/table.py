"""What a verdict on a real recording is worth, and the tables: hits beside misses, estimates beside the published values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import compress
from typing import Any

from experiments.recordings.cases import Case, Concealed, key
from experiments.verdicts.scoring import NOTHING_CONCEALED, score
from greybox_torch.diagnosis.settings import DiagnosisSettings

LEAST_BROUGHT = DiagnosisSettings().least_size
"""Share of the squared validation error that the full published model has to remove for what it has more to be shown: a finding's."""


def row(case: Case, verdict: Mapping[str, Any], fit: Mapping[str, Any] | None) -> dict[str, Any]:
    """One recording scored, as it goes into results.json.

    Args:
        verdict: verdict.json of the model that lacks something.
        fit: fit.json of the full published model, None where there is none to fit.
    """
    answers = key(case)
    scored = score(case.name, verdict, answers)
    near = [pair for pairs in answers["near"] for pair in pairs]
    estimates = [_estimate(c, verdict, fit) for c in case.concealed if fit]
    brings = _brought(verdict, fit) if case.concealed and fit else None
    enough = brings is None or brings >= LEAST_BROUGHT
    shown = [enough and e["shown"] for e in estimates] or [True] * len(scored.effects)
    findings = [
        {
            "port": f.port,
            "mechanism": f.mechanism,
            "probability": f.probability,
            "right": f.right,
            "near": not f.right and [f.port, f.mechanism] in near,
        }
        for f in scored.findings
    ]
    among = score(case.name, verdict, _only(answers, shown))
    return {
        "recording": case.name,
        "concealed": list(scored.effects),
        "brings": brings,
        "shown": {"effects": sum(shown), "named": among.named, "located": among.located},
        "detected": scored.detected,
        "named": scored.named,
        "located": scored.located,
        "worse": scored.worse,
        "contradictions": scored.contradictions,
        "complete": verdict.get("complete", True),
        "seconds": verdict["seconds"],
        "found": [f for f in findings if f["right"] or f["near"]],
        "besides": [f for f in findings if not (f["right"] or f["near"])],
        "fit": [
            {
                "experiment": concealed["experiment"],
                "role": concealed["role"],
                "output": concealed["output"],
                "without": concealed["refit"]["fit"],
                "found": concealed["augmented"]["fit"],
                "published": None if published is None else published["refit"]["fit"],
            }
            for concealed, published in zip(
                verdict["fit"], fit["fit"] if fit else [None] * len(verdict["fit"]), strict=True
            )
        ],
        "estimates": estimates,
    }


def _only(answers: Mapping[str, Any], shown: Sequence[bool]) -> dict[str, Any]:
    """An answer key with those of its effects alone that are ``shown``."""
    if not any(shown):
        return {**answers, **NOTHING_CONCEALED}
    return {**answers, **{n: list(compress(answers[n], shown)) for n in ("effects", "accept", "near", "ports")}}


def _brought(verdict: Mapping[str, Any], fit: Mapping[str, Any]) -> float:
    """Share of the squared validation error of the re-estimated model that the full published one removes, mean over outputs."""
    pairs = [
        (row["refit"]["rmse"], full["refit"]["rmse"])
        for row, full in zip(verdict["fit"], fit["fit"], strict=True)
        if row["role"] == "validation"
    ]
    left = [(full / max(without, 1e-300)) ** 2 for without, full in pairs if without is not None and full is not None]
    return 1.0 - sum(left) / len(left) if left else 0.0


def _estimate(concealed: Concealed, verdict: Mapping[str, Any], fit: Mapping[str, Any]) -> dict[str, Any]:
    """The concealed quantity as published, as the full model's fit has it, and as the verdict states it (None where it does not)."""
    full = fit["parameters"][concealed.parameter]
    found = None
    for reading in concealed.readings:
        for effect in verdict["effects"]:
            if found is None and effect["mechanism"] == reading.mechanism and effect["port"] in concealed.ports:
                value = effect["parameters"][reading.parameter]
                scale = reading.sign / (effect["parameters"][reading.over]["value"] if reading.over else 1.0)
                std = None if value["std"] is None else abs(scale) * value["std"]
                found = {"mechanism": effect["mechanism"], "value": scale * value["value"], "std": std}
    return {
        "parameter": concealed.parameter,
        "shown": _shown(full),
        "unit": concealed.unit,
        "published": concealed.published,
        "full_model": {"value": full["value"], "std": full["std_sandwich"]},
        "found": found,
    }


def _shown(full: Mapping[str, Any]) -> bool:
    """Whether the full model, fitted, has the quantity more than two standard deviations from zero.

    What the publication measured in other ways and fixed is taken as shown, and so is what trades for other parameters so that no
    deviation is known: there what the full model removes decides alone.
    """
    std = full["std_sandwich"]
    return full["fixed"] or std is None or abs(full["value"]) > 2 * std


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Two Markdown tables: what was found and what it is worth, then the estimates."""
    lines = [
        "| recording | concealed | found of it | besides | named | validation fit [%]: without, found, published model "
        "| published model removes [%] | s |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        fits = "; ".join(
            f"{f['output']} {', '.join(_percent(f[stage]) for stage in ('without', 'found', 'published'))}"
            for f in r["fit"]
            if f["role"] == "validation"
        )
        shown = r["shown"]["effects"]
        named = f"{r['named']}/{len(r['concealed'])}" + ("" if shown == len(r["concealed"]) else f" ({shown} shown)")
        named = named if r["concealed"] else "right" if r["detected"] else "false alarm"
        cells = (
            r["recording"],
            ", ".join(r["concealed"]) or "nothing",
            _list(r["found"]),
            _list(r["besides"]),
            named,
            fits,
            "" if r["brings"] is None else f"{100 * r['brings']:.1f}",
            f"{r['seconds']:.0f}" + ("" if r["complete"] else ", time limit"),
        )
        lines.append(f"| {' | '.join(cells)} |")
    lines += [
        "",
        "| recording | quantity | unit | published | full model fitted | found | as |",
        "|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        for e in r["estimates"]:
            found = e["found"]
            cells = (
                r["recording"], e["parameter"], e["unit"],
                "" if e["published"] is None else f"{e['published']:.4g}",
                _number(e["full_model"]),
                "not stated" if found is None else _number(found),
                "" if found is None else found["mechanism"],
            )  # fmt: skip
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, "", *_totals(rows)]) + "\n"


def _totals(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """What a reader wants to know first."""
    effects = sum(len(r["concealed"]) for r in rows)
    shown, named, located = (sum(r["shown"][what] for r in rows) for what in ("effects", "named", "located"))
    complete = [r for r in rows if not r["concealed"]]
    alarms, worse = (
        [r["recording"] for r in complete if not r["detected"]],
        [r["recording"] for r in rows if r["worse"]],
    )
    contradicted = [r["recording"] for r in rows if r["contradictions"]]
    return [
        f"- Effects left out: {effects}; named {sum(r['named'] for r in rows)}, rightly placed {sum(r['located'] for r in rows)}.",
        f"- Of these the recordings show {shown}: named {named}, rightly placed {located}.",
        f"- Nothing left out: {len(complete)} cases; {_names(alarms)} said to lack something.",
        f"- Recommended model worse on validation than the re-estimated one: {_names(worse)}.",
        f"- Verdicts that contradict themselves: {_names(contradicted)}.",
    ]


def _names(recordings: Sequence[str]) -> str:
    return f"{len(recordings)}" + (f" ({'; '.join(recordings)})" if recordings else "")


def _percent(fit: float | None) -> str:
    return "–" if fit is None else f"{fit:.1f}"


def _list(findings: Sequence[Mapping[str, Any]]) -> str:
    return ", ".join(f"{f['mechanism']} at {f['port']} ({f['probability']:.2f})" for f in findings) or "nothing"


def _number(value: Mapping[str, Any]) -> str:
    return f"{value['value']:.4g}" + ("" if value["std"] is None else f" ± {value['std']:.2g}")
