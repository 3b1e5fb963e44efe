"""Row 4: the published estimation in a fresh process, imports and compilation included."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from experiments.speed.row import Entry, Row, Target
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import CHECKOUT, PUBLISHED_CARD, SHARED, Settings
from experiments.speed.timing import interleaved

TITLE = "Published estimation in a fresh process"
NEEDS = Needs(peers=("jax", "optimistix"), recordings=True)
RECORDING = SHARED / "recordings" / "robot_arm" / "RobotArm.mat"
TOLERANCE = 1e-4

WARM, COLD = "greybox fit, machine code in the cache", "greybox fit, nothing in the cache"
WRITTEN, OPTIMISTIX = "JAX script, LM written out", "JAX script, optimistix"


def measure(settings: Settings, progress: Progress) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        place, errors = Path(folder), {}

        def ours(name: str, cache: Path | None) -> None:
            result = _output(
                [
                    sys.executable,
                    "-m",
                    "greybox_torch",
                    "fit",
                    str(PUBLISHED_CARD),
                    "--out",
                    str(place / "out"),
                    "--json",
                ],
                {} if cache is None else {"GREYBOX_CACHE": str(cache)},
            )
            errors[name] = result["statistics"]["mse"]

        def cold() -> None:
            with tempfile.TemporaryDirectory(dir=place) as empty:
                ours(COLD, Path(empty))

        def script(name: str, method: str) -> None:
            command = [sys.executable, "-m", "experiments.speed.peers.jax_fit", method, str(RECORDING)]
            errors[name] = _output(command, {})["mse"]

        rivals = {
            WARM: lambda: ours(WARM, None),
            COLD: cold,
            WRITTEN: lambda: script(WRITTEN, "written out"),
            OPTIMISTIX: lambda: script(OPTIMISTIX, "optimistix"),
        }
        if settings.quick:
            del rivals[OPTIMISTIX]
        progress("timing fresh processes")
        times = {name: t.median for name, t in interleaved(rivals, repeats=settings.repeats(5)).items()}
    same = {n: abs(mse / errors[WARM] - 1) <= TOLERANCE for n, mse in errors.items()}
    jax = min((times[n] for n in (WRITTEN, OPTIMISTIX) if same.get(n)), default=None)
    notes = {n: f"MSE {errors[n]:.6g}{'' if same[n] else ', NOT the same optimum'}" for n in rivals}
    return Row(
        "fresh_process",
        TITLE,
        entries=tuple(Entry(n, times[n], ours=n in (WARM, COLD), note=notes[n]) for n in rivals),
        targets=(
            Target("no slower than the faster JAX script, warm cache", "at least", 1.0, jax and jax / times[WARM]),
            Target("no slower than the faster JAX script, cold cache", "at least", 1.0, jax and jax / times[COLD]),
        ),
        agreement=f"all must end within {TOLERANCE:.0e} of our mean squared error",
        notes=(
            "greybox fit also estimates standard deviations, judges both experiments and writes a checkpoint; the scripts only estimate",
            "JAX without its persistent compilation cache, as by default",
        ),
    )


def _output(command: list[str], extra: dict[str, str]) -> dict:
    """What a process prints as JSON on its standard output."""
    done = subprocess.run(
        command, cwd=CHECKOUT, env={**os.environ, **extra}, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with {done.returncode}: {done.stderr.strip()[-2000:]}")
    return json.loads(done.stdout)
