"""Verdicts on a folder of cases: made, compared, scored.

    python -m experiments.verdicts run CASES [CASES …] --out VERDICTS [--workers 2] [--time-limit S] [--only NAME,…]
    python -m experiments.verdicts compare BEFORE AFTER [--only NAME,…]
    python -m experiments.verdicts score CASES VERDICTS

`run` diagnoses every data set's card in or below the folders CASES (cards, and lists of lines NAME CARD, are taken too) into
VERDICTS/NAME; it never reads a key, and what has a verdict is passed over. Exit code 1 where a case ended without a verdict.
`compare` says case by case whether two such folders are equal to the last digit but for seconds, or what changed; exit code 1 where
something did. `score` holds the verdicts against CASES/**/key.json. Exit code 2: the arguments are at fault.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from experiments.verdicts.cards import chosen_cards, find_cards, names_of
from experiments.verdicts.comparison import compare_all
from experiments.verdicts.running import Outcome, diagnose_all, has_verdict
from experiments.verdicts.scoring import score_all
from greybox_torch import UserError


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        return options.command(options)
    except UserError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the same command goes on from here", file=sys.stderr)
        return 130


def _run(options: argparse.Namespace) -> int:
    cards = chosen_cards(find_cards(options.cases), options.only)
    left = {name: card for name, card in cards.items() if not has_verdict(options.out / name)}
    if len(left) < len(cards):
        print(f"{len(cards) - len(left)} of {len(cards)} cases have their verdict", flush=True)
    failed: list[str] = []
    done = len(cards) - len(left)

    def tell(name: str, outcome: Outcome) -> None:
        nonlocal done
        done += 1
        failed.extend([name] * bool(outcome.failure))
        print(f"{done}/{len(cards)} {name} {outcome.seconds:.0f} s: {outcome.said}", flush=True)

    diagnose_all(left, options.out, workers=options.workers, time_limit=options.time_limit, tell=tell)
    if failed:
        print(f"{len(failed)} cases ended without a verdict: {', '.join(sorted(failed))}", file=sys.stderr)
    return int(bool(failed))


def _compare(options: argparse.Namespace) -> int:
    changes = compare_all(options.before, options.after, names_of(options.only))
    for change in changes:
        print(f"{change.name}: {'equal' if not change.changes else ''}".rstrip())
        for what in change.changes:
            print(f"    {what}")
    different = sum(bool(change.changes) for change in changes)
    print(f"{len(changes) - different} of {len(changes)} cases are equal")
    return int(different > 0)


def _score(options: argparse.Namespace) -> int:
    from experiments.verdicts.totals import table

    scored = score_all(options.cases, options.verdicts)
    if not scored:
        raise UserError(f"{options.cases}: no key.json is in or below it; expected cases with their keys")
    print(table(scored))
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m experiments.verdicts",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(required=True, metavar="run | compare | score")
    run = commands.add_parser("run", help="diagnose every case")
    run.add_argument("cases", type=Path, nargs="+", metavar="CASES", help="folders, cards, or lists of lines NAME CARD")
    run.add_argument("--out", type=Path, required=True, metavar="VERDICTS")
    run.add_argument("--workers", type=positive, default=2, help="cases side by side, which share the cores")
    run.add_argument("--time-limit", type=positive, help="seconds of search for a case")
    run.add_argument("--only", default="", help="names of cases, separated by commas")
    run.set_defaults(command=_run)
    compare = commands.add_parser("compare", help="equal to the last digit, or what changed")
    compare.add_argument("before", type=Path, metavar="BEFORE")
    compare.add_argument("after", type=Path, metavar="AFTER")
    compare.add_argument(
        "--only", default="", help="names of cases, separated by commas; all that either folder has by default"
    )
    compare.set_defaults(command=_compare)
    scores = commands.add_parser("score", help="verdicts against keys")
    scores.add_argument("cases", type=Path, metavar="CASES")
    scores.add_argument("verdicts", type=Path, metavar="VERDICTS")
    scores.set_defaults(command=_score)
    return parser


def positive(text: str) -> int:
    """A whole number from 1 on, for argparse."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"is {value}; expected at least 1")
    return value


if __name__ == "__main__":
    sys.exit(main())
