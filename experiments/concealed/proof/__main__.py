"""The proof: `python -m experiments.concealed.proof [--set standard|quick] [--seed N] [--out DIR]`.

Draws cases, seals the answers and prints the commitment, runs `greybox diagnose` on every case, opens the seal, scores, and writes
results, figures and a page. It can be interrupted, or killed, and goes on where it was. Once the seal is open, further verdicts are
refused: a new proof needs a new folder.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from experiments.concealed.proof.errors import ProofError
from experiments.concealed.proof.protocol import Proof


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m experiments.concealed.proof",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--set", choices=("standard", "quick"), default="standard")
    parser.add_argument("--seed", type=_seed, help="drawn on the day if not given")
    parser.add_argument(
        "--out", type=Path, default=None, help="folder of the proof (results/proof, results/proof-quick)"
    )
    parser.add_argument(
        "--page", type=Path, default=None, help="where the page goes, its figures beside it (OUT/proof.md)"
    )
    parser.add_argument("--workers", type=_positive, default=2, help="cases side by side, one thread each")
    parser.add_argument("--time-limit", type=_positive, default=90, help="seconds of search for a case")
    options = parser.parse_args(arguments)
    out = options.out or Path("results") / ("proof" if options.set == "standard" else "proof-quick")
    try:
        run(out, options.page or out / "proof.md", options.set, options.seed, options.workers, options.time_limit)
    except ProofError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    return 0


def run(out: Path, page: Path, kind: str, seed: int | None, workers: int, time_limit: float) -> None:
    """All steps of the proof; those that are done are passed over."""
    from experiments.concealed.proof.page import publish

    began = time.perf_counter()

    def progress(text: str) -> None:
        print(f"[{time.perf_counter() - began:5.0f} s] {text}", flush=True)

    proof = Proof(out, progress)
    proof.prepare(kind, seed, workers=workers)
    proof.diagnose(workers=workers, time_limit=time_limit)
    answers = proof.open()
    print(publish(proof, answers, page))


def _positive(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"is {value}; expected at least 1")
    return value


def _seed(text: str) -> int:
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"is {value}; expected a number from 0 on")
    return value


if __name__ == "__main__":
    raise SystemExit(main())
