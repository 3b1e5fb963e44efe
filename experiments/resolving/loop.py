"""One case: first recordings, a diagnosis, the recording that it asks for, and a diagnosis of all; beside it a random input."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

import greybox_torch as gt
from experiments.concealed.excitation import multisine
from experiments.concealed.workshop.plant import Array
from experiments.resolving.bench import CARD, Bench, draw
from experiments.resolving.judging import also_right, is_open, leading, nearest, pairs_of, probability_of, realised
from greybox_torch.errors import UserError
from greybox_torch.files import json_text, write_text
from greybox_torch.systems import load_model

OUTCOME = "outcome.json"
FURTHER = 18
"""Beside the seed and the number of a case: draws the random input, and the noise of further recordings."""
PHASES, SMALLER = 10, 0.8
"""Draws of a random input's phases before it is made smaller, and the factor on it."""
RAISED = 20
"""Times that a random input is raised for what the limits of the input cut from it."""


def run_case(folder: Path, seed: int, number: int) -> None:
    """Writes FOLDER/outcome.json when all is done; whatever a stopped run left is written anew."""
    bench = draw(seed, number)
    bench.write(folder)
    found, seconds = _diagnosed(folder / CARD)
    outcome: dict[str, Any] = bench.key | {"number": number, "open": is_open(found.to_dict()), "said": found.sentence}
    _keep(folder, "first", found, seconds)
    if outcome["open"]:
        outcome |= _asked(bench, folder, found, seed, np.random.default_rng([seed, FURTHER, number]))
    write_text(folder / OUTCOME, json_text(outcome))


def _asked(bench: Bench, folder: Path, found: gt.DiagnosisResult, seed: int, rng: Generator) -> dict[str, Any]:
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
    return told | _recorded(bench, folder, designed, inputs, wanted, pairs, rng)


def _recorded(
    bench: Bench,
    folder: Path,
    designed: gt.DesignResult,
    inputs: Array,
    wanted: set[tuple[str, str]],
    pairs: dict[str, tuple[str, str]],
    rng: Generator,
) -> dict[str, Any]:
    """The machine on the designed input and on a random one of the same power, and the diagnoses with each."""
    told: dict[str, Any] = {"limits_kept": bench.within(inputs), "limits_kept_in_simulation": _inside(designed)}
    for name, values in (("designed", inputs), ("random", random_input(bench, inputs, rng))):
        card = bench.add(folder, name, bench.record(values, int(rng.integers(2**31))))
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


def random_input(bench: Bench, like: Array, rng: Generator) -> Array:
    """A multisine over the frequencies that a design may use, of the same mean square.

    Phases are drawn anew until the machine keeps its limits; only where none of so many keep them, it is made smaller.
    """
    factor = 1.0
    while True:
        for _ in range(PHASES):
            found = _multisines(bench, factor * np.sqrt(np.mean(like**2, axis=0)), len(like), rng)
            if bench.within(found):
                return found
        factor *= SMALLER


def _multisines(bench: Bench, wanted: Array, samples: int, rng: Generator) -> Array:
    """Inputs (samples, inputs) of so large a root mean square (inputs,) after their peaks were cut to the limits."""
    step = bench.machine.sample_time
    found = np.empty((samples, len(wanted)))
    for i, channel in enumerate(bench.machine.inputs):
        low, high = bench.machine.limits[channel.name]
        shape = multisine(rng, samples, step, 0.9 / (samples * step), 0.125 / step)
        gain = wanted[i]
        for _ in range(RAISED):
            found[:, i] = np.clip(gain * shape, low, high)
            gain *= wanted[i] / np.sqrt(np.mean(found[:, i] ** 2))
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
