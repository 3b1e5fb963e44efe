"""The page beside a machine's checkpoints: what each is, its figures, how it was made."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from experiments.make_checkpoints.machines import Machine
from experiments.make_checkpoints.steps import Made, commit, held_out
from experiments.speed.settings import header
from greybox_torch import Checkpoint, DataSet, Evaluation

FACTS = ("processor", "cores", "compiler", "python")


def page(
    machine: Machine,
    data: DataSet,
    made: Made,
    runs: Mapping[str, Evaluation],
    kept: Mapping[str, Checkpoint],
    verdict: str,
) -> str:
    """Markdown, every figure in it from what was made."""
    lines = [
        f"# {data.name}",
        "",
        f"Written by `python -m experiments.make_checkpoints`; do not edit. Recordings: `{machine.card.name}`, SHA-256 of the samples",
        f"`{data.sha256}`.",
        "",
        "| model | made by | parameters | greybox_torch, torch | commit | created |",
        "|---|---|---|---|---|---|",
        *(_model(name, kept[name], made) for name in made.models),
        "",
        "Free run of whole experiments, start states from the first tenth of each; fit in %, root mean square error in the output's unit:",
        "",
        "| experiment | role | output | " + " | ".join(f"{name}: fit | rmse" for name in runs) + " |",
        "|---|---|---|" + "---|---|" * len(runs),
        *_scores(runs),
        "",
        f"Verdict: {verdict}",
        "",
        "Networks that were tried, and the mean squared error of their free run on the stretches of the estimation experiments that no",
        "step was taken on. The lowest is kept; validation experiments had no part in that, and their figures are here as they came out:",
        "",
        "| network | held out: physics | hybrid | penalty | validation fit, mean [%] | seconds |",
        "|---|---|---|---|---|---|",
        *_tried(made),
        "",
        "Machine: " + "; ".join(f"{name} {value}" for name, value in header().items() if name in FACTS) + ".",
        "",
    ]
    return "\n".join(lines)


def _model(name: str, checkpoint: Checkpoint, made: Made) -> str:
    ways = {"physics": "`greybox fit`", "named": "`greybox diagnose`", "hybrid": f"`greybox train`, {made.network}"}
    versions = ", ".join(checkpoint.versions[package] for package in ("greybox_torch", "torch"))
    facts = (
        f"[{name}]({name}.json)",
        ways[name],
        len(checkpoint.values),
        versions,
        commit(made.models[name]),
        checkpoint.created,
    )
    return f"| {' | '.join(map(str, facts))} |"


def _scores(runs: Mapping[str, Evaluation]) -> list[str]:
    rows = []
    for together in zip(*(run.scores for run in runs.values()), strict=True):
        first = together[0]
        numbers = " | ".join(f"{row['fit']:.2f} | {row['rmse']:.4g}" for row in together)
        rows.append(f"| {first['experiment']} | {first['role']} | {first['output']} | {numbers} |")
    return rows


def _tried(made: Made) -> list[str]:
    rows = []
    for network, result in made.tried.items():
        penalty = result["statistics"]["penalty"]
        fits = [row["augmented"]["fit"] for row in result["fit"] if row["role"] == "validation"]
        chosen = " (kept)" if network == made.network else ""
        weight = "physics alone" if penalty is None else f"{penalty:g}"
        rows.append(
            f"| {network}{chosen} | {held_out(result, None):.4g} | {held_out(result):.4g} | {weight} | "
            f"{sum(fits) / len(fits):.2f} | {result['seconds']:.0f} |"
        )
    return rows


def size(folder: Path) -> int:
    """Bytes of all files below ``folder``."""
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
