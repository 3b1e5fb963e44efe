"""The protocol, step by step: draw and seal, let the tool speak, open, score. Every step is done once, and taken up where it was left."""

from __future__ import annotations

import json
import os
import secrets
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

from experiments.concealed.proof.draw import draw_cases
from experiments.concealed.proof.errors import ProofError
from experiments.concealed.proof.files import sha256, write_json
from experiments.concealed.proof.plan import plans
from experiments.concealed.proof.record import Record
from experiments.concealed.proof.seal import seal, unseal
from experiments.concealed.trial_files import KEY, digest
from experiments.verdicts.running import VERDICT, Outcome, diagnose_all

Progress = Callable[[str], None]
ROOT = Path(__file__).parents[3]
RULES = (
    "experiments/verdicts/scoring.py",
    "greybox_torch/diagnosis/contradictions.py",
    "experiments/verdicts/rates.py",
    "experiments/concealed/proof/promises.py",
)
"""What decides on right and wrong; may not change between sealing and scoring."""


class Proof:
    """One proof in its folder: cases/, verdicts/, record.jsonl, the sealed answers."""

    def __init__(self, folder: Path, progress: Progress = print) -> None:
        self.folder, self.progress = folder, progress
        self.record = Record(folder / "record.jsonl")

    def prepare(self, kind: str, seed: int | None, *, workers: int = 1) -> None:
        """Draw the cases and seal the answers, unless that is done. Without a seed one is drawn.

        Raises ProofError where the folder holds a proof of another set or seed.
        """
        if self.record.sealed is not None:
            self._same(kind, seed)
            self.progress(self._announcement())
            return
        seed = self._seed(seed)
        planned = plans(kind, seed)
        self.progress(f"seed {seed}: {len(planned)} cases")
        # A folder of its own for every run: processes of one that was killed may go on writing into theirs.
        partial, cases = self.folder / f"cases.partial-{os.getpid()}", self.folder / "cases"
        for leftover in (*self.folder.glob("cases.partial*"), cases):  # of runs killed before the answers were sealed
            shutil.rmtree(leftover, ignore_errors=True)
        answers = draw_cases(planned, seed, partial, workers=workers, progress=self.progress)
        partial.rename(cases)
        commitment = seal(self.folder, answers)
        self.record.add(
            "sealed",
            set=kind,
            seed=seed,
            commitment=commitment,
            cases={name: digest(cases / name) for name in answers},
            rules=rules_hash(),
            tool=tool_version(),
        )
        self.progress(self._announcement())

    def diagnose(self, *, workers: int, time_limit: float) -> None:
        """Let the tool speak on every case that it has not spoken on. Refused once the seal is open."""
        self._unchanged_cases()
        if self.record.opened is None:
            self._unchanged_tool()
            cases = self._sealed()["cases"]
            left = {n: self.folder / "cases" / n / "dataset.toml" for n in cases if n not in self.record.verdicts}
            out = self.folder / "verdicts"
            diagnose_all(left, out, workers=workers, time_limit=time_limit, tell=self._freeze)

    def _freeze(self, name: str, outcome: Outcome) -> None:
        """Put on record what the tool said of a case: the hash of its verdict, None where there is none."""
        file = self._verdict_file(name)
        found = None if outcome.failure else sha256(file.read_bytes())
        self.record.add("verdict", case=name, sha256=found, said=outcome.said, seconds=outcome.seconds)
        done, total = len(self.record.verdicts), len(self._sealed()["cases"])
        self.progress(f"{done}/{total} {name} {outcome.seconds:.0f} s: {outcome.said}")

    def open(self) -> dict[str, Any]:
        """Open the seal, once every case has its verdict; the answers by case, which are now beside the data too.

        Raises ProofError where verdicts, cases, answers or rules are not those on the record.
        """
        self.check_verdicts()
        self._unchanged_cases()
        sealed = self._sealed()
        if self.record.opened is None:
            self._unchanged_tool()
        if sealed["rules"] != rules_hash():
            raise ProofError(
                "the rules of scoring have changed since the answers were sealed; expected those of the sealing"
            )
        answers = unseal(self.folder, sealed["commitment"])
        if self.record.opened is None:
            self.record.add("opened", verdicts=len(self.record.verdicts))
        for name, key in answers.items():
            write_json(self.folder / "cases" / name / KEY, key)
        return answers

    def check_verdicts(self) -> None:
        """Raises ProofError unless every case has a frozen verdict, and every verdict is the frozen one."""
        frozen = self.record.verdicts
        missing = [name for name in self._sealed()["cases"] if name not in frozen]
        if missing:
            raise ProofError(
                f"{self.record.file}: no verdict yet on {len(missing)} cases, {missing[0]} among them; expected one on each"
            )
        for name, entry in frozen.items():
            file = self._verdict_file(name)
            found = sha256(file.read_bytes()) if file.is_file() else None
            if found != entry["sha256"]:
                raise ProofError(
                    f"{file}: "
                    + ("is not there" if found is None else f"has the hash {found}")
                    + f"; frozen at {entry['time']} was {entry['sha256'] or 'no verdict'}: a verdict produced or changed later is refused"
                )

    def verdict(self, name: str) -> dict[str, Any] | None:
        """What the tool said of a case, None where it said nothing."""
        file = self._verdict_file(name)
        return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else None

    def _verdict_file(self, name: str) -> Path:
        return self.folder / "verdicts" / name / VERDICT

    def _sealed(self) -> dict[str, Any]:
        if self.record.sealed is None:
            raise ProofError(f"{self.record.file}: nothing is sealed yet")
        return self.record.sealed

    def _announcement(self) -> str:
        sealed = self._sealed()
        return f"seed {sealed['seed']}, sealed {sealed['time']}; commitment to the answers {sealed['commitment']}"

    def _same(self, kind: str, seed: int | None) -> None:
        sealed = self._sealed()
        if sealed["set"] != kind or seed not in (None, sealed["seed"]):
            raise ProofError(
                f"{self.folder}: holds a proof of the {sealed['set']} set with seed {sealed['seed']}, asked for was {kind}"
                + (f" with seed {seed}" if seed is not None else "")
                + "; expected the same, or another --out"
            )

    def _seed(self, seed: int | None) -> int:
        """The seed asked for, or one drawn today, kept so that an interrupted drawing goes on with it."""
        file = self.folder / "seed.json"
        if seed is None and file.exists():
            seed = int(json.loads(file.read_text())["seed"])
        if seed is None:
            seed = secrets.randbelow(10**8)
        write_json(file, {"seed": seed})
        return seed

    def _unchanged_tool(self) -> None:
        """Verdicts of two versions are not one proof."""
        sealed, now = self._sealed()["tool"]["sources"], tool_version()["sources"]
        if now != sealed:
            raise ProofError(
                f"greybox_torch: its sources have the hash {now}, at the sealing {sealed}; expected the tool that was sealed"
            )

    def _unchanged_cases(self) -> None:
        for name, sealed in self._sealed()["cases"].items():
            if digest(self.folder / "cases" / name) != sealed:
                raise ProofError(
                    f"{self.folder / 'cases' / name}: changed since it was sealed; expected the files as they were drawn"
                )


def rules_hash() -> str:
    """SHA-256 over the files that decide on right and wrong."""
    return sha256(b"\0".join((ROOT / name).read_bytes() for name in RULES))


def tool_version() -> dict[str, str]:
    """The commit that is checked out, and a hash over the tool's sources."""
    files = sorted((ROOT / "greybox_torch").rglob("*.py"))
    git = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False)
    return {"commit": git.stdout.strip(), "sources": sha256(b"\0".join(file.read_bytes() for file in files))}
