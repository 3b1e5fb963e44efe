"""The results as JSON, figures, and a page in Markdown, all written from the run."""

from __future__ import annotations

import os
import platform
import statistics
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.concealed.proof.figures import draw_all
from experiments.concealed.proof.files import write_bytes, write_json
from experiments.concealed.proof.plan import SECTIONS
from experiments.concealed.proof.promises import STRONG, Promise, promises, scored_cases
from experiments.concealed.proof.protocol import ROOT, Proof
from experiments.concealed.proof.results import results
from experiments.concealed.proof.tables import case_table, group_table, mark, misses, promise_table, sweeps
from experiments.verdicts.scoring import Scored

CAPTIONS = {
    "confusion.png": "What was concealed (rows) against what was said (columns), by kind of port and mechanism. A right answer lies on the "
    "diagonal, whichever of its twins it names.",
    "strength.png": "Detected, located and named against how visible the effect is. Ticks: the cases.",
    "closure.png": "How many cases have at least so much of their validation error closed.",
    "reliability.png": "What came true of what was claimed (95 %): names; exact names, without look-alikes; answers, of which names that "
    "the key accepts are one; classes.",
}
BESIDE = (
    (
        "Against other tools, on the same cases",
        "against/against.md",
        "python -m experiments.concealed.against PROOF/cases PROOF/against --verdicts PROOF/verdicts",
    ),
    (
        "On real recordings, known physics concealed",
        "recordings/results.md",
        "python -m experiments.recordings PROOF/recordings",
    ),
)
"""Tables that other commands write into the folder of the proof, and that the page takes in: heading, file, command."""

PROTOCOL = """\
1. Cases are drawn from the seed: machine, true parameters, start values up to 15 % off, excitation, feedback, noise, read-out, torque
   noise, slow drift and jitter of the samples, all anew for each. The plants
   ([`experiments/concealed`]({root}/experiments/concealed/README.md)) are NumPy, or MuJoCo's, and share no code
   with the tool; they integrate more finely than it does, their dry friction truly sticks.
   Effects are scaled until the plain model, refitted in linearisation, leaves an error of 2.5 to 4 (weak), 8 to 20 (moderate), 40 to
   100 (dominant) or 300 to 3000 times (overwhelming, with sensors 30 times as good) the floor, or as far as the machine lets them; the key
   holds the visibility that came out. Effects of a pair are made visible beside each other: what the run with both has more than that
   with the other alone is measured likewise.
2. The answers, with all that counts as right, are sealed: encrypted, and committed to by a salted SHA-256 that is printed and put on
   record with the hashes of all cases, of the rules of scoring and of the tool's sources.
3. The tool is run on each case by its command line. It sees the card, the recordings and the nominal model. The hash of each verdict goes
   on record as it comes; a verdict that comes later, or is changed, is refused.
4. The seal is opened, the commitment checked, and every verdict scored by the rules in
   [`verdicts/scoring.py`]({root}/experiments/verdicts/scoring.py). A case without a verdict counts as missed. Where the tool says
   that it took a validation experiment to choose with as well, the share of the error closed is that over the experiments left.

The seed is public and the generator deterministic, so whoever runs the proof could look up the answers: what is blind is the tool, not the
person. The record keeps anybody from choosing among verdicts afterwards without leaving a trace in it."""


def publish(proof: Proof, answers: Mapping[str, Mapping[str, Any]], page: Path) -> str:
    """Write results.json into the proof's folder, figures beside the page, and the page; a summary in text."""
    verdicts = {name: proof.verdict(name) for name in answers}
    found = scored_cases(answers, verdicts, proof.record.verdicts)
    kept = promises(found)
    folder = page.parent / page.stem
    figures = draw_all(found, folder)
    everything = results(proof, found, kept)
    write_json(proof.folder / "results.json", everything)
    if folder != proof.folder:
        write_json(folder / "results.json", everything)
    root = os.path.relpath(ROOT, page.parent).replace(os.sep, "/")
    write_bytes(page, _page(proof, found, kept, figures, folder.name, root).encode())
    return "\n".join([*(f"{mark(p):12s} {p.what}: {p.measured} (wanted {p.wanted})" for p in kept), f"page: {page}"])


def _page(
    proof: Proof, found: Sequence[Scored], kept: Sequence[Promise], figures: Sequence[str], folder: str, root: str
) -> str:
    parts = [
        "# The proof: concealed effects, scored blind",
        _about(proof, found),
        "## What was promised, and what came out",
        promise_table(kept),
        "## Protocol",
        PROTOCOL.format(root=root),
        "## By kind of case",
        group_table(found, "section", SECTIONS, lambda r: str(r.key["section"])),
        "## By strength",
        group_table([r for r in found if r.effects], "strength", ("weak", *STRONG), lambda r: r.strength),
        "## By machine",
        group_table(found, "machine", sorted({r.key["machine"] for r in found}), lambda r: str(r.key["machine"])),
        "## Figures",
        "\n\n".join(f"![{CAPTIONS[name]}]({folder}/{name})\n\n{CAPTIONS[name]}" for name in figures),
        *sweeps(found),
        "## What failed, and why",
        misses(found),
        *_beside(proof.folder),
        "## All cases",
        case_table(found),
    ]
    return "\n\n".join(parts) + "\n"


def _about(proof: Proof, found: Sequence[Scored]) -> str:
    sealed, opened = proof.record.sealed or {}, proof.record.opened or {}
    seconds = [float(r.seconds) for r in found]
    short = "make proof" if sealed["set"] == "standard" else "make proof-quick"
    command = f"python -m experiments.concealed.proof --set {sealed['set']} --seed {sealed['seed']}"
    return (
        f"Written by `{command}` ({short}) from its run: {len(found)} cases, seed {sealed['seed']}, sealed {sealed['time']}, "
        f"opened {opened.get('time')}. Tool: commit `{sealed['tool']['commit'][:12]}`, sources "
        f"`{sealed['tool']['sources'][:12]}`. Commitment to the answers: `{sealed['commitment']}`. One thread a case on "
        f"{os.cpu_count()} cores ({platform.machine()}): median {statistics.median(seconds):.0f} s a case, slowest {max(seconds):.0f} s. "
        f"In {sum(map(_took_more, found))} cases the tool took a validation experiment to choose with as well."
    )


def _took_more(row: Scored) -> bool:
    """Whether fewer experiments are left to judge than the three that every case has."""
    judged = {fit["experiment"] for fit in row.verdict["fit"] if fit["role"] == "validation"} if row.verdict else ()
    return row.verdict is not None and len(judged) < 3


def _beside(folder: Path) -> list[str]:
    parts = []
    for heading, file, command in BESIDE:
        table = folder / file
        text = table.read_text(encoding="utf-8").strip() if table.is_file() else f"Not part of this run (`{command}`)."
        parts += [f"## {heading}", text]
    return parts
