"""One case: first recordings, a diagnosis, the recording that it asks for, and a diagnosis of all; beside it a random input."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np

import greybox_torch as gt
from experiments.concealed.excitation import multisine
from experiments.concealed.workshop.plant import Array
from experiments.resolving.bench import CARD, Bench, draw
from experiments.resolving.judging import also_right, is_open, leading, nearest, pairs_of, probability_of, realised
from greybox_torch.errors import UserError
from greybox_torch.files import json_text, write_text
from greybox_torch.systems import load_model

OUTCOME = "outcome.json"
SMALLER = 0.8
"""Factor on a random input until the machine keeps within its limits."""


def run_case(folder: Path, seed: int, number: int) -> None:
    """Writes FOLDER/outcome.json when all is done; whatever a stopped run left is written anew."""
    bench = draw(seed, number)
    bench.write(folder)
    found, seconds = _diagnosed(folder / CARD)
    outcome: dict[str, Any] = bench.key | {"number": number, "open": is_open(found.to_dict()), "said": found.sentence}
    _keep(folder, "first", found, seconds)
    if outcome["open"]:
        outcome |= _asked(bench, folder, found, seed)
    write_text(folder / OUTCOME, json_text(outcome))


def _asked(bench: Bench, folder: Path, found: gt.DiagnosisResult, seed: int) -> dict[str, Any]:
    right = {(port, mechanism) for port, mechanism in bench.key["accept"]}
    began, used = time.perf_counter(), time.process_time()
    try:
        designed = gt.design(found, seed=seed)
    except UserError as error:
        return {"refused": str(error), "before": probability_of(found.to_dict(), right)}
    told: dict[str, Any] = {"design_seconds": time.perf_counter() - began, "sentence": designed.sentence}
    told["design_processor"] = time.process_time() - used
    write_text(folder / "design.json", designed.to_json())
    pairs = pairs_of(designed, found)
    alike = [(pairs[a], pairs[b]) for a, b in designed.alike]
    wanted = also_right(right, alike)
    told |= {
        "hypotheses": [list(pairs[name]) for name in designed.names],
        "expected": designed.expected.after,
        "expected_random": designed.expected.random,
        "alike": [[list(a), list(b)] for a, b in alike],
        "leading": leading(dict(zip(pairs.values(), designed.expected.before, strict=True)), alike),
        "before": probability_of(found.to_dict(), wanted),
    }
    inputs = np.stack([designed.inputs[c.name] for c in bench.machine.inputs], axis=1)
    return told | _recorded(bench, folder, designed, inputs, wanted, pairs, seed)


def _recorded(
    bench: Bench,
    folder: Path,
    designed: gt.DesignResult,
    inputs: Array,
    wanted: set[tuple[str, str]],
    pairs: dict[str, tuple[str, str]],
    seed: int,
) -> dict[str, Any]:
    """The machine on the designed input and on a random one of the same power, and the diagnoses with each."""
    told: dict[str, Any] = {"limits_kept": bench.within(inputs), "limits_kept_in_simulation": _inside(designed)}
    for name, values in (("designed", inputs), ("random", random_input(bench, inputs, seed))):
        card = bench.add(folder, name, bench.record(values, seed + 1))
        found, seconds = _diagnosed(card)
        _keep(folder, name, found, seconds)
        told[name] = {"said": found.sentence, "probability": probability_of(found.to_dict(), wanted)}
        told[name]["open"] = is_open(found.to_dict())
    rights = [k for k, name in enumerate(designed.names) if pairs[name] in wanted]
    others = [k for k, name in enumerate(designed.names) if pairs[name] not in wanted]
    if rights and others:
        nats = designed.expected.nats
        rival = nearest(nats, rights[0], others)
        before, after = gt.load_dataset(folder / CARD), gt.load_dataset(folder / "with_designed.toml")
        told["rival"] = designed.names[rival]
        told["predicted_nats"] = float(nats[rights[0], rival])
        told["realised_nats"] = realised(designed, rights[0], rival, before, after)
    return told


def random_input(bench: Bench, like: Array, seed: int) -> Array:
    """A multisine over the frequencies that a design may use, of the same mean square, made smaller until the machine allows it."""
    samples, step = len(like), bench.machine.sample_time
    rng = np.random.default_rng([seed, samples])
    found = np.empty_like(like)
    for i, channel in enumerate(bench.machine.inputs):
        low, high = bench.machine.limits[channel.name]
        power = float(np.sqrt(np.mean(like[:, i] ** 2)))
        found[:, i] = np.clip(power * multisine(rng, samples, step, 0.9 / (samples * step), 0.125 / step), low, high)
    while not bench.within(found):
        found = SMALLER * found
    return found


def _inside(designed: gt.DesignResult) -> bool:
    """Whether input and outputs lie within the limits under every hypothesis."""
    limits = designed.limits
    fine = [
        bool((u >= limits.inputs[n].lower).all() and (u <= limits.inputs[n].upper).all())
        for n, u in designed.inputs.items()
    ]
    for outputs in designed.outputs:
        for (_, own), y in zip(limits.outputs.items(), outputs.T, strict=True):
            fine.append(bool((y >= own.lower).all() and (y <= own.upper).all()))
    return all(fine)


def _diagnosed(card: Path) -> tuple[gt.DiagnosisResult, float]:
    began = time.perf_counter()
    data = gt.load_dataset(card)
    found = gt.diagnose(load_model(str(data.model)), data)
    return found, time.perf_counter() - began


def _keep(folder: Path, name: str, found: gt.DiagnosisResult, seconds: float) -> None:
    write_text(folder / f"{name}.json", json.dumps(found.to_dict() | {"wall": seconds}, indent=1))
