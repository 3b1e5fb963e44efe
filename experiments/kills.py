"""Commands killed at random moments: `python -m experiments.kills --kills 48 --out results/kills`.

`fit`, `diagnose`, `export` and `fleet` are begun again and again and sent SIGKILL, SIGTERM or SIGINT (Ctrl-C) at a moment drawn between
their start and their usual end. Counted is what must not be: a file under its own name that is not whole, a traceback, a process that is
still there 30 s later, and a next run that does not end as one that nobody disturbed. Then two commands are begun at once with an empty
cache of compiled code, and each command with a limit on the size of its files, as on a disk that is full. Writes OUT/kills.json.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from experiments.fleets.generate import write_fleet
from experiments.fleets.plan import draw_fleet
from experiments.whole_files import is_whole, named_files

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
PATIENCE = 30.0
"""Seconds after a signal within which everything has ended."""

LIMITS = (0, 4, 32, 128)
"""kB that a file may have, where the disk is full."""


@dataclass(frozen=True)
class Case:
    """A command, where it writes, and what of its results is the same whenever it is run."""

    name: str
    arguments: tuple[str, ...]
    out: Path
    answer: Callable[[Path], Any]


@dataclass(frozen=True)
class Kill:
    """One kill: of what, how, after how many seconds, and what was wrong after it."""

    command: str
    sent: str
    after: float
    code: int
    wrong: tuple[str, ...]
    left: int
    """Temporary files that lie there, under names of their own."""


def cases(folder: Path, seed: int) -> list[Case]:
    """The four commands on small motors; export has a result to export."""
    machines = draw_fleet(8, 1, seed)
    with_drag = [m for m in machines if m.effect and m.sizes[0] > 0.0][:2]
    cards = write_fleet(with_drag, folder / "data", samples=200, seed=seed)
    out, card = folder / "out", str(cards[0])
    model = f"{folder / 'data' / 'motor.py'}:Motor"
    fitted = folder / "fitted"
    _run(["fit", card, "--out", str(fitted)], os.environ)
    return [
        Case("fit", ("fit", card), out / "fit", lambda o: _rounded(_json(o / "fit.json")["parameters"])),
        Case("diagnose", ("diagnose", card), out / "diagnose", lambda o: _named(_json(o / "verdict.json"))),
        Case("export", ("export", str(fitted), "--to", "c", "--model", model), out / "export", _contents),
        Case(
            "fleet",
            ("fleet", str(folder / "data"), "--workers", "1"),
            out / "fleet",
            lambda o: [_named(_json(file)) for file in sorted(o.rglob("verdict.json"))],
        ),
    ]


def killed(case: Case, usual: float, answer: Any, sent: signal.Signals, rng: np.random.Generator) -> Kill:
    """Begins a command in an empty folder, kills it, looks at what is there, and lets the next run end."""
    shutil.rmtree(case.out, ignore_errors=True)
    after = float(rng.uniform(0.0, 1.05 * usual))
    process = _begin(case)
    time.sleep(after)
    process.send_signal(sent)
    wrong = []
    try:
        _, errors = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        _, errors = process.communicate()
        wrong.append(f"still there {PATIENCE:.0f} s later")
    if _lingering(process.pid):
        wrong.append("processes of it are left")
        os.killpg(process.pid, signal.SIGKILL)
    if "Traceback" in errors:
        wrong.append(f"a traceback: {errors.strip().splitlines()[-1]}")
    wrong += [f"half-written: {file.relative_to(case.out)}" for file in named_files(case.out) if not is_whole(file)]
    again = _run([*case.arguments, "--out", str(case.out)], os.environ)
    if again.returncode != 0 or case.answer(case.out) != answer:
        wrong.append(f"the next run: exit {again.returncode}, {again.stderr.strip()[-200:]}")
    left = sum(1 for file in case.out.rglob(".*.partial*"))
    return Kill(case.name, sent.name, after, process.returncode, tuple(wrong), left)


def cold_cache(case: Case, folder: Path) -> list[str]:
    """What is wrong where two commands begin at once with an empty cache."""
    cache = folder / "cold"
    shutil.rmtree(cache, ignore_errors=True)
    both = [
        subprocess.Popen(
            _command([*case.arguments, "--out", str(folder / f"cold_{k}")]),
            env={**os.environ, "GREYBOX_CACHE": str(cache)},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        for k in range(2)
    ]
    wrong = [f"exit {p.returncode}: {errors}" for p in both if (errors := p.communicate()[1]) and p.returncode != 0]
    answers = [case.answer(folder / f"cold_{k}") for k in range(2)] if not wrong else []
    if len(answers) == 2 and answers[0] != answers[1]:
        wrong.append("the two differ")
    return wrong + [f"left in the cache: {f.name}" for f in cache.iterdir() if f.suffix != ".so"]


def full_disk(case: Case, folder: Path, kilobytes: int) -> dict[str, Any]:
    """What a command says and leaves where no file may be larger; the cache of compiled code is as it is."""
    out = folder / "full"
    shutil.rmtree(out, ignore_errors=True)
    limit = (1024 * kilobytes, 1024 * kilobytes)
    run = subprocess.run(
        _command([*case.arguments, "--out", str(out)]),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit),
        capture_output=True,
        text=True,
        check=False,
    )
    wrong = [f"half-written: {f.relative_to(out)}" for f in named_files(out) if not is_whole(f)]
    if "Traceback" in run.stderr:
        wrong.append("a traceback")
    if run.returncode not in (0, 2, 3):
        wrong.append(f"exit {run.returncode}")
    said = run.stderr.strip().splitlines()[-1:]
    return {"command": case.name, "kB": kilobytes, "exit": run.returncode, "said": said, "wrong": wrong}


def _begin(case: Case) -> subprocess.Popen[str]:
    return subprocess.Popen(
        _command([*case.arguments, "--out", str(case.out)]),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def _run(arguments: Sequence[str], environment: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(_command(arguments), env=environment, capture_output=True, text=True, check=False)


def _command(arguments: Sequence[str]) -> list[str]:
    return [sys.executable, "-m", "greybox_torch", *arguments]


def _lingering(group: int) -> bool:
    """Whether any process of a group is still there after a while."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return False
        time.sleep(0.2)
    return True


def _json(file: Path) -> Any:
    return json.loads(file.read_text())


def _rounded(parameters: dict[str, dict[str, Any]]) -> dict[str, float]:
    return {name: float(f"{entry['value']:.6g}") for name, entry in parameters.items()}


def _named(verdict: dict[str, Any]) -> Any:
    effects = [(e["port"], e["mechanism"], round(e["probability"], 4)) for e in verdict["effects"]]
    return verdict["dataset"], verdict["mismatch"], effects


def _contents(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in named_files(folder)}


def main(arguments: list[str] | None = None) -> int:
    """0 where nothing was wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=48, help="of all commands together")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", nargs="*", default=["fit", "diagnose", "export", "fleet"])
    parser.add_argument("--out", type=Path, default=Path("results/kills"))
    chosen = parser.parse_args(arguments)
    out: Path = chosen.out.resolve()
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # children of a job in the background would ignore it
    rng = np.random.default_rng(chosen.seed)
    every = [case for case in cases(out, chosen.seed) if case.name in chosen.commands]
    kills: list[Kill] = []
    full: list[dict[str, Any]] = []
    for k, case in enumerate(every):
        for _ in range(2):  # the second time with its steppers in the cache
            began = time.monotonic()
            _run([*case.arguments, "--out", str(case.out)], os.environ)
            usual, answer = time.monotonic() - began, case.answer(case.out)
            shutil.rmtree(case.out)
        for n in range(chosen.kills // len(every)):
            kills.append(killed(case, usual, answer, SIGNALS[(n + k) % len(SIGNALS)], rng))
            print(asdict(kills[-1]), flush=True)
        full += [full_disk(case, out, kilobytes) for kilobytes in LIMITS if case.name != "fleet"]
    cold = [problem for case in every if case.name == "fit" for problem in cold_cache(case, out)]
    wrong = [k for k in kills if k.wrong]
    told = {
        "kills": len(kills),
        "wrong": len(wrong),
        "left": sum(k.left for k in kills),
        "cold_cache": cold,
        "full": full,
    }
    (out / "kills.json").write_text(json.dumps({**told, "every": [asdict(k) for k in kills]}, indent=1))
    print(json.dumps(told, indent=1))
    return int(bool(wrong or cold or any(f["wrong"] for f in full)))


if __name__ == "__main__":
    raise SystemExit(main())
