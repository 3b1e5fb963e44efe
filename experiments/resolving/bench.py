"""A machine on its bench: what is drawn for a case, its first recordings, and any further one. Shares nothing with the tool."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.workshop.draw import _runs
from experiments.concealed.workshop.files import card_text, write_table
from experiments.concealed.workshop.integrate import Experiment, noise_of, simulate
from experiments.concealed.workshop.plant import Array, Concealed, Drive, Seen
from experiments.concealed.workshop.visibility import left_by_a_refit
from experiments.resolving.machines import MACHINES, QUESTIONS
from experiments.resolving.machines.base import Limited, Question

CARD, KEY = "dataset.toml", "key.json"
STREAM = 7
"""Beside the seed and the number of a case, so that no other experiment draws the same."""


@dataclass(frozen=True)
class Bench:
    """One machine with what is concealed in it. ``starts``: the states that first recordings begin with; ``sigma``: noise (outputs,)."""

    question: Question
    plan: str
    machine: Limited
    truth: Mapping[str, float]
    hidden: Concealed
    starts: Sequence[Sequence[float]]
    sigma: Array
    runs: Sequence[Experiment]
    rng: Generator

    def record(self, inputs: Array, seed: int) -> Experiment:
        """A recording on inputs (samples, inputs), open loop, begun as the first one was."""
        noise = noise_of(np.random.default_rng(seed), list(self.sigma), len(inputs))
        return self._replayed(inputs, noise)

    def within(self, inputs: Array) -> bool:
        """Whether the machine itself keeps its outputs within their limits, noise apart."""
        shown = self._replayed(inputs, np.zeros((len(inputs), len(self.sigma)))).outputs
        ranges = [self.machine.limits.get(c.name, (-np.inf, np.inf)) for c in self.machine.outputs]
        return all(bool((low <= y).all() and (y <= high).all()) for (low, high), y in zip(ranges, shown.T, strict=True))

    def write(self, folder: Path) -> None:
        """The first recordings with a card that names the limits, and the key beside them."""
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self.machine.model_file, folder / "model.py")
        scales = [c.scale for c in (*self.machine.inputs, *self.machine.outputs)]
        for j, run in enumerate(self.runs):
            write_table(folder / f"e{j}.csv", self.machine, run, scales)
        seconds = self.machine.samples * self.machine.sample_time
        limits = [f"{n} = {{ lower = {low}, upper = {high} }}" for n, (low, high) in self.machine.limits.items()]
        card = card_text(self.machine, self.rng, self.truth, scales)
        (folder / CARD).write_text("\n".join([card, "[limits]", f"seconds = {seconds:g}", *limits, ""]))
        (folder / KEY).write_text(json.dumps(self.key, indent=1) + "\n")

    def add(self, folder: Path, name: str, run: Experiment) -> Path:
        """A further recording, and a card of all of them, as its user would write it."""
        scales = [c.scale for c in (*self.machine.inputs, *self.machine.outputs)]
        write_table(folder / f"{name}.csv", self.machine, run, scales)
        added = f'[[experiment]]\nname = "{name}"\nfile = "{name}.csv"\nrole = "estimation"\n\n[model]\n'
        card = folder / f"with_{name}.toml"
        card.write_text((folder / CARD).read_text().replace("[model]\n", added, 1))
        return card

    @property
    def key(self) -> dict[str, Any]:
        """What is concealed, and which answers are right."""
        accept = [list(pair) for pair in self.machine.catalogue[self.plan].accept]
        return {"question": self.question.name, "machine": self.machine.name, "effect": self.plan, "accept": accept}

    def _replayed(self, inputs: Array, noise: Array) -> Experiment:
        none = Drive(np.zeros((len(inputs), 0)), np.zeros((len(inputs), 0)))
        still = [0.0] * len(self.sigma)
        return simulate(
            self.machine,
            self.truth,
            none,
            self.hidden,
            start=self.starts[0],
            noise=noise,
            resolution=still,
            replay=inputs,
        )


def draw(seed: int, number: int) -> Bench:
    """Case ``number``: the questions in turn, of each its effects in turn; all else at random."""
    rng = np.random.default_rng(SeedSequence([seed, STREAM, number]))
    question = QUESTIONS[number % len(QUESTIONS)]
    plan = question.plans[number // len(QUESTIONS) % len(question.plans)]
    machine = MACHINES[question.machine]
    truth = machine.draw_truth(rng)
    drives = [machine.drive(rng, j, truth) for j in range(machine.experiments)]
    starts = [machine.start(rng, truth) for _ in drives]
    plain = _runs(machine, truth, drives, starts, Concealed())
    seen = Seen(truth, *(np.stack([getattr(run, part) for run in plain]) for part in ("states", "inputs", "outputs")))
    hidden = machine.catalogue[plan].draw(rng, seen)
    clean = _runs(machine, truth, drives, starts, hidden)
    usual = np.array([run.outputs.std(axis=0) for run in plain]).mean(axis=0)
    share = left_by_a_refit(machine, truth, clean, starts, usual) / np.exp(rng.uniform(*np.log(question.visibility)))
    sigma = share * usual
    still = [0.0] * len(usual)
    runs = [
        simulate(
            machine, truth, d, hidden, start=s, noise=noise_of(rng, list(sigma), machine.samples), resolution=still
        )
        for d, s in zip(drives, starts, strict=True)
    ]
    return Bench(question, plan, machine, truth, hidden, starts, sigma, runs, rng)
