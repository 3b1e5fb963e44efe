"""One diagnosis with its time by stage and its passes by purpose, as JSON on standard output; run in a process of its own:

python experiments/speed/diagnosis/profiled.py CARD OUT [OPTION…]

It imports whatever ``greybox_torch`` is on the path, so that one program measures two commits.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from collections import defaultdict
from pathlib import Path
from types import FrameType
from typing import Any

PURPOSES = {
    ("periodic_orders.py", "scan_orders"): "screen: orders",
    ("periodic_orders.py", "_peaks"): "screen: orders",
    ("score_test.py", "scores"): "screen: effects",
    ("rank.py", "tried"): "trials",
    ("rank.py", "in_full"): "finalists",
    ("behind_curve.py", "laws_behind_curve"): "laws behind a curve",
    ("compare.py", "_polished"): "polishing",
    ("likelihood.py", "cost_of"): "likelihood of whole records",
    ("finer_curve.py", "with_finer_curve"): "finer curves",
    ("backward.py", "_without"): "without an effect",
    ("explore.py", "_from_given"): "the way passed over",
    ("simpler_laws.py", "_contained"): "simpler laws",
    ("held_out.py", "held_out_fits"): "held out",
    ("final.py", "finish"): "whole records",
    ("free_runs.py", "__init__"): "free runs",
    ("plain_model.py", "fit_plain_model"): "the plain model",
}
"""What a pass is for, by the file and the function that asked for it; the innermost one counts."""


class Passes:
    """Counts passes: how many, their samples times (1 + tangents), and their seconds, by purpose."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.by_purpose: dict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))

    def count(self, purpose: str, **amounts: float) -> None:
        """Add to a purpose."""
        with self.lock:
            for name, amount in amounts.items():
                self.by_purpose[purpose][name] += amount


CARRYING = {("carried_starts.py", "carried_starts"), ("carried.py", "carried_starts")}


def purpose_of(frame: FrameType | None) -> str:
    """The purpose of what runs in ``frame``; passes that only bring carried states along are told apart."""
    carrying = ""
    while frame is not None:
        place = (Path(frame.f_code.co_filename).name, frame.f_code.co_name)
        if place in CARRYING:
            carrying = ", carrying states"
        if place in PURPOSES:
            return PURPOSES[place] + carrying
        frame = frame.f_back
    return "other" + carrying


def watch(passes: Passes) -> None:
    """Have every pass of the compiled stepper, and every compilation, counted; none in a commit whose stepper is elsewhere."""
    try:
        from greybox_torch.simulation import native
    except ImportError:
        return

    plain_run, plain_library = native.NativeStepper.run, native.library

    def run(self: Any, records: Any, asked: Any, substeps: int = 1) -> Any:
        began = time.thread_time()
        result = plain_run(self, records, asked, substeps)
        seconds = time.thread_time() - began
        directions = (len(self.sensitive) if asked.tangents else 0) + (
            0 if asked.start_directions is None else asked.start_directions.shape[1]
        )
        samples = float((asked.windows.last - asked.windows.start + 1).sum())
        passes.count(
            purpose_of(sys._getframe(1)),
            passes=1,
            samples=samples,
            work=samples * substeps * (1 + directions),
            seconds=seconds,
        )
        return result

    def library(source: str) -> Any:
        began = time.thread_time()
        result = plain_library(source)
        passes.count("compiling and loading", passes=1, seconds=time.thread_time() - began)
        return result

    native.NativeStepper.run = run
    native.library = library


def leave_out_installed() -> None:
    """Import nothing from the tree that is installed for editing: it would stand in for modules that another commit does not have."""
    sys.meta_path[:] = [f for f in sys.meta_path if not getattr(f, "__module__", "").startswith("__editable__")]


Heard = list[tuple[float, list[tuple[str, str]]]]
"""After how many seconds which effects, as ports and mechanisms, were told as the leading finding."""


def hear(began: float) -> Heard:
    """What a diagnosis tells of its leading finding from now on; nothing where the package does not tell it yet."""
    heard: Heard = []
    try:
        from greybox_torch.diagnosis.progress import Journal
    except ImportError:
        return heard
    plain = Journal._tell

    def tell(self: Any, **changes: Any) -> None:
        if "effects" in changes:
            heard.append((time.perf_counter() - began, [tuple(e) for e in changes["effects"]]))
        plain(self, **changes)

    Journal._tell = tell
    return heard


def main(card: str, out: str, *more: str) -> int:
    """Diagnose ``card`` into the folder ``out`` as from the shell; the passes by purpose go to its ``passes.json``."""
    began = time.perf_counter()
    leave_out_installed()
    passes = Passes()
    watch(passes)
    heard = hear(began)
    from greybox_torch.cli import main as command

    imported, processor = time.perf_counter() - began, time.process_time()
    sys.argv = ["greybox", "diagnose", card, "--out", out, *more]
    try:
        command()
        code = 0
    except SystemExit as ended:
        code = int(ended.code or 0)
    took = {
        "imports": imported,
        "seconds": time.perf_counter() - began,
        "processor": time.process_time() - processor,
        "passes": passes.by_purpose,
        "heard": heard,
    }
    if code == 0:
        (Path(out) / "passes.json").write_text(json.dumps(took, indent=1))
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
