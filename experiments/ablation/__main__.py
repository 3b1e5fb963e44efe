"""What each part of a model brings: `python -m experiments.ablation --out results/ablation [CARD …]`.

Physics as published, re-estimated, with the mechanisms that a diagnosis names, with a network, with both, and a network alone, on each
data set: by default the recordings of the robot arm where they are there, and two concealed cases that are generated. Writes
OUT/CASE/results.json after every model, and goes on there when it is interrupted; at the end OUT/results.md with a figure per case.

    python -m experiments.ablation --out OUT CARD --verdict DIR      # with the diagnosis that `greybox diagnose` wrote to DIR
"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path

from experiments.ablation.diagnosis import diagnosis
from experiments.ablation.ladder import MODELS, RANDOM, Ladder
from experiments.ablation.networks import NetworkChoice, usual_networks
from experiments.ablation.page import write
from experiments.ablation.results import Case, load_case
from experiments.concealed.generate import main as generate
from experiments.speed.settings import ALL_FREE_CARD, PUBLISHED_CARD, header
from greybox_torch import NumericalError, TrainingSettings, UserError, load_dataset, load_model

CONCEALED = "speed_bump,backlash"
SAME = ("data", "quick", "networks")
"""What results must agree in to be gone on with."""


def main(arguments: list[str] | None = None) -> int:
    """0 where every case was measured; the exit codes of the command line otherwise."""
    chosen = _parsed(arguments)
    try:
        write(chosen.out, [_measured(card, chosen) for card in chosen.cards or _usual_cards(chosen)])
    except UserError as error:
        print(error, file=sys.stderr)
        return 2
    except NumericalError as error:
        print(error, file=sys.stderr)
        return 3
    return 0


def _usual_cards(chosen: argparse.Namespace) -> list[Path]:
    cards = [ALL_FREE_CARD] if PUBLISHED_CARD.is_file() else []
    if not cards:
        _tell("the robot arm: skipped, as its recordings are not in ../shared beside the checkout")
    cases = chosen.out / "cases"
    names = chosen.concealed.split(",")
    if not cases.is_dir():
        _tell(f"generating concealed cases: {chosen.concealed}")
        generate([str(cases), "--cases", str(len(names)), "--effects", chosen.concealed, "--seed", "7"])
    return [*cards, *sorted(cases.glob("*/dataset.toml"))]


def _measured(card: Path, chosen: argparse.Namespace) -> Case:
    data = load_dataset(card)
    if data.model is None:
        raise UserError(f"{card}: [model] name is missing; expected a built-in system or a file and class")
    if not data.validation():
        raise UserError(f'{card}: no experiment has the role "validation"; expected one to score on')
    model, name = load_model(data.model), card.parent.name if card.stem == "dataset" else card.stem
    networks = [NetworkChoice.parsed(n) for n in chosen.networks] or usual_networks(model)
    folder = chosen.out / name
    about = {"data": data.sha256, "title": data.name, "quick": chosen.quick, "machine": header()}
    case = load_case(folder, name, {**about, "networks": [str(n) for n in networks]}, SAME)
    settings = TrainingSettings(epochs=5, factors=(1,)) if chosen.quick else TrainingSettings()
    diagnose = partial(diagnosis, data, folder / "diagnosis", chosen.verdict, chosen.time_limit)
    tell, effort, commit = partial(_tell, name), 0.02 if chosen.quick else 1.0, about["machine"]["commit"]
    ladder = Ladder(data, model, case, diagnose, networks, settings, effort, commit, tell)
    for kind in chosen.models or MODELS:
        for seed in range(chosen.seeds) if kind in RANDOM else (None,):
            if case.find(kind, seed) is None:
                tell(MODELS[kind] if seed is None else f"{MODELS[kind]}, seed {seed}")
                entry = ladder.measure(kind, seed)
                if entry is None:
                    tell(f"{MODELS[kind]}: nothing of the kind was found")
                    break
                case.entries.append(entry)
                case.save(folder)
                tell(f"fit {entry.estimation:.2f} %, validation {entry.validation:.2f} %, {entry.seconds:.0f} s")
    return case


def _tell(*text: str) -> None:
    print(": ".join(text), file=sys.stderr, flush=True)


def _parsed(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m experiments.ablation", description=str(__doc__).splitlines()[0])
    parser.add_argument("cards", type=Path, nargs="*", help="data sets; by default the robot arm and concealed cases")
    parser.add_argument("--out", type=Path, required=True, help="folder for results")
    parser.add_argument("--seeds", type=int, default=5, help="of everything random")
    parser.add_argument("--models", nargs="*", choices=list(MODELS), default=[], help="some of the models only")
    parser.add_argument("--networks", nargs="*", default=[], help="candidates, as KIND:PORT:SIGNAL+SIGNAL")
    parser.add_argument("--verdict", type=Path, help="folder of an earlier diagnosis, for one data set")
    parser.add_argument("--time-limit", type=float, default=120.0, help="of a diagnosis made here, in s")
    parser.add_argument("--concealed", default=CONCEALED, help="effects of the generated cases")
    parser.add_argument("--quick", action="store_true", help="shrink everything to see that it works")
    chosen = parser.parse_args(arguments)
    if chosen.verdict is not None and len(chosen.cards) != 1:
        parser.error("--verdict: a diagnosis belongs to one data set; name that one")
    if chosen.seeds < 1:
        parser.error(f"--seeds {chosen.seeds}: expected at least 1")
    return chosen


if __name__ == "__main__":
    sys.exit(main())
