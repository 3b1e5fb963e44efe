"""The hypotheses that a diagnosis leaves: kept beside its verdict, and read again for the next recording."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from greybox_torch.api.expected import AS_IN_A_DIAGNOSIS, NOTHING, decided
from greybox_torch.api.inseparable import inseparable
from greybox_torch.checkpoint import Checkpoint, checkpoint_files
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.errors import UserError
from greybox_torch.files import json_text
from greybox_torch.mechanisms.attached import attached
from greybox_torch.mechanisms.stored import stored_effects
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.copies import copy_holding
from greybox_torch.reading import read_json
from greybox_torch.restored import load_beside
from greybox_torch.result_names import HYPOTHESES, MODEL, RIVALS, VERDICT
from greybox_torch.systems import load_model, model_reference

if TYPE_CHECKING:
    from greybox_torch.api.diagnosis_result import DiagnosisResult
    from greybox_torch.diagnosis.describe.rivals import Rival

SCHEMA = "greybox-hypotheses/1"
_OF_A_HYPOTHESIS = re.compile(r"\d+-.+\.(json|safetensors)")
Starts = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class Kept:
    """A hypothesis: its ``name``, its ``probability`` among its rivals, a ``model`` that holds its values, start states by recording and
    state, and what the verdict gives it: less where much is left beside it, or where the search was stopped; None for a rival. ``limited``:
    why it is less, clauses.
    """

    name: str
    probability: float
    model: GreyBoxModel
    starts: Starts
    in_verdict: float | None = None
    limited: tuple[str, ...] = ()


@dataclass(frozen=True)
class Hypotheses:
    """The ``recommended`` model, for each finding the hypotheses of which it is one, the finding first, whether the search that they are of
    ran to its end, and the verdict's sentence of what is ``left`` of the mismatch ("" where that is not far above the noise).
    """

    data: DataSet
    reference: str
    recommended: Kept
    findings: tuple[tuple[Kept, ...], ...]
    complete: bool = True
    left: str = ""


def hypotheses_of(result: DiagnosisResult) -> Hypotheses:
    """Those of a diagnosis that is in memory."""
    found: dict[str, list[Kept]] = {}
    for r in result.found.rivals:
        held = copy_holding(r.model, r.values, starts_free=True)
        one = Kept(spoken_at(r.mechanism, r.port), r.probability, held, r.initial, *_in_verdict(result, r))
        found.setdefault(r.finding, []).append(one)
    recommended = Kept("the recommended model", 1.0, result.model, result.initial)
    groups = tuple(tuple(group) for group in found.values())
    rest = result.verdict.left
    left = "" if rest is None else _if_large(rest.times_noise, rest.sentence)
    return Hypotheses(result.data, model_reference(result.given), recommended, groups, result.verdict.complete, left)


def _in_verdict(result: DiagnosisResult, rival: Rival) -> tuple[float | None, tuple[str, ...]]:
    """What the verdict gives a finding, and why no more; None and nothing for a rival."""
    own = f"{rival.port}.{rival.mechanism}" == rival.finding
    told = ((e.probability, e.limited) for e in result.effects if own and e.prefix == rival.finding)
    return next(told, (None, ()))


def hypothesis_files(folder: Path, result: DiagnosisResult, checkpoint: Checkpoint) -> dict[Path, str | bytes]:
    """What `greybox design` needs of a diagnosis, to be written with its verdict: a list, and a checkpoint for each hypothesis."""
    files: dict[Path, str | bytes] = {}
    findings: dict[str, list[dict[str, Any]]] = {}
    for k, rival in enumerate(result.found.rivals, start=1):
        name = f"{k}-{rival.port}-{rival.mechanism}"
        own = Checkpoint(
            model=checkpoint.model,
            title=checkpoint.title,
            values=rival.values,
            units={p.name: p.unit for p in rival.model.declared_parameters},
            effects=stored_effects(rival.model),
            free_starts=True,
            own_weights=checkpoint.own_weights,
            dataset=checkpoint.dataset,
        )
        files |= checkpoint_files(folder / RIVALS / name, own)
        entry = {"checkpoint": f"{RIVALS}/{name}", "port": rival.port, "mechanism": rival.mechanism}
        in_verdict, limited = _in_verdict(result, rival)
        entry |= {"probability": rival.probability, "initial": rival.initial, "in_verdict": in_verdict}
        entry |= {"limited": list(limited)} if limited else {}
        findings.setdefault(rival.finding, []).append(entry)
    path = result.data.path
    content = {
        "schema": SCHEMA,
        "dataset": None if path is None else str(path.absolute()),
        "model": checkpoint.model,
        "initial": result.initial,
        "findings": list(findings.values()),
        "complete": result.verdict.complete,
    }
    return {**files, folder / HYPOTHESES: json_text(content)}


def kept_hypotheses(folder: Path) -> list[Path]:
    """The files of the hypotheses that some diagnosis has left in a folder; none that goes by another kind of name."""
    return [path for path in (folder / RIVALS).glob("*") if _OF_A_HYPOTHESIS.fullmatch(path.name)]


def read_hypotheses(folder: Path, model: str | None = None) -> Hypotheses:
    """Those that `greybox diagnose` has left in a folder.

    Args:
        model: how to load the plain model, where the data set's card names none.

    Raises:
        UserError: the folder holds no such results, they are damaged, or the data set that they are of is not there.
    """
    path = folder / HYPOTHESES
    content = _content(path)
    card = content.get("dataset")
    if not isinstance(card, str):
        raise UserError(
            f"{path}: the diagnosis was of recordings in memory, which are not here any more; expected results of a data set with a card "
            "(from Python, design() takes the result of diagnose itself)"
        )
    data = load_dataset(Path(card))
    name = model or data.model
    if name is None:
        raise UserError(
            f"{card}: [model] name is missing and no --model is given; expected the model that was diagnosed"
        )
    own = load_model(name)
    try:
        groups = [[_kept(folder, entry, own, data) for entry in group] for group in content["findings"]]
        starts = _starts(content["initial"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UserError(
            f"{path}: damaged: {type(error).__name__}: {error}; expected what greybox diagnose writes"
        ) from None
    recommended, data = load_beside(folder / MODEL, own, data)
    found = Kept("the recommended model", 1.0, recommended, starts)
    whole = bool(content.get("complete", True))
    return Hypotheses(data, name, found, tuple(tuple(group) for group in groups), whole, _left(folder / VERDICT))


def _left(verdict: Path) -> str:
    """What the verdict beside hypotheses says of the rest; "" where that is little, or the verdict is not there any more."""
    if not verdict.is_file():
        return ""
    content = read_json(verdict, "results of greybox diagnose")
    left = content.get("left") if isinstance(content, dict) else None
    return _if_large(left.get("times_noise"), str(left.get("sentence", ""))) if isinstance(left, dict) else ""


def _if_large(times_noise: Any, sentence: str) -> str:
    """The sentence where it speaks of more than laws that tell the whole story leave."""
    large = isinstance(times_noise, int | float) and times_noise >= AS_IN_A_DIAGNOSIS.far_above_noise
    return sentence if large else ""


def _content(path: Path) -> dict[str, Any]:
    command = f"greybox diagnose CARD --out {shlex.quote(str(path.parent))}"
    content = read_json(path, f"results of greybox diagnose (`{command}` writes them)")
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        found = content.get("schema") if isinstance(content, dict) else type(content).__name__
        raise UserError(f'{path}, "schema": found {found!r}, expected "{SCHEMA}"')
    return content


def _kept(folder: Path, entry: Mapping[str, Any], own: GreyBoxModel, data: DataSet) -> Kept:
    model, _ = load_beside(folder / str(entry["checkpoint"]), own, data)
    name, in_verdict = spoken_at(str(entry["mechanism"]), str(entry["port"])), entry.get("in_verdict")
    in_verdict = None if in_verdict is None else float(in_verdict)
    limited = tuple(str(clause) for clause in entry.get("limited", ()))
    return Kept(name, float(entry["probability"]), model, _starts(entry["initial"]), in_verdict, limited)


def _starts(content: Mapping[str, Mapping[str, Any]]) -> Starts:
    return {recording: {state: float(value) for state, value in own.items()} for recording, own in content.items()}


def to_tell_apart(held: Hypotheses) -> tuple[Sequence[Kept], Sequence[Kept]]:
    """The hypotheses of the finding that is least sure, nothing where none has a rival; and the rivals of all findings that are left out.

    Of findings that are as unsure as may be whatever is recorded, as their rivals are one effect with them, only where no other is open.

    The finding is the recommended model, which has all effects. A rival that was fitted when another of these was still missing would be
    told from it by that one, so it is left out.
    """
    best, final = held.recommended, _effects(held.recommended.model)
    groups, left_out = [], []
    for first, *rivals in held.findings:
        group = [replace(first, model=best.model, starts=best.starts)]
        for rival in rivals:
            lacking = final - _effects(rival.model)
            (group if len(lacking) <= 1 else left_out).append(rival)  # one is the finding itself
        groups.append(group)
    open_ones = [group for group in groups if len(group) > 1]
    in_turn = sorted(open_ones, key=lambda group: group[0].probability)
    first = in_turn[0] if in_turn else ()
    return next((g for g in in_turn if not (decided([k.probability for k in g]) or inseparable(g))), first), left_out


def left_out_told(left_out: Sequence[Kept]) -> tuple[str, ...]:
    """Which rivals are left out and why, a sentence for each that a diagnosis would list."""
    return tuple(
        f"Left out is {kept.name} (probability {kept.probability:.2g}), which was fitted when other effects were still missing."
        for kept in left_out
        if kept.probability >= NOTHING
    )


def _effects(model: GreyBoxModel) -> set[str]:
    return {attachment.prefix for attachment in attached(model)[1]}
