"""Run the other ways on cases of concealed effects, and set them beside the tool's own verdicts.

    python -m experiments.concealed.against CASES OUT [--verdicts VERDICTS] [--methods retuned,sindy,network] [--only NAME,…]

Writes OUT/NAME/BASELINE.json for every case CASES/NAME/dataset.toml and every baseline; what is there is passed over, so that an
interrupted run goes on where it was. Keys (CASES/NAME/key.json, or --keys) are read at the end alone, to score, where they are there:
OUT/against.json and OUT/against.md.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from experiments.concealed.against.table import compared, table
from greybox_torch import UserError
from greybox_torch.errors import GreyboxError, did_you_mean
from greybox_torch.files import json_text, write_text

METHOD_NAMES = ("retuned", "sindy", "network")


def run(cases: Path, out: Path, methods: Sequence[str], names: Sequence[str]) -> int:
    """Run the methods on the named cases, all where none is named; the number of cases that could not be run.

    Raises:
        UserError: there is no such case, or pysindy is wanted and not installed.
    """
    there = sorted(card.parent.name for card in cases.glob("*/dataset.toml"))
    if not there:
        raise UserError(f"{cases}: no folder in it has a dataset.toml; expected a folder of cases")
    for name in names:
        if name not in there:
            raise UserError(f"--only: {cases} has no case {name}{did_you_mean(name, there)}")
    if "sindy" in methods and find_spec("pysindy") is None:
        raise UserError("--methods sindy: pysindy is not installed; expected the extra [proof], or other methods")
    return sum(not _run_case(cases / name, out / name, methods) for name in names or there)


def _run_case(case: Path, out: Path, methods: Sequence[str]) -> bool:
    from experiments.concealed.against.methods import METHODS, results
    from experiments.concealed.against.plain import retune

    began, plain = time.perf_counter(), None
    for method in methods:
        files = [out / f"{baseline}.json" for baseline in METHODS[method][0]]
        if all(file.exists() for file in files):
            continue
        try:
            plain = plain or retune(case / "dataset.toml")
        except GreyboxError as error:
            print(f"{case.name}: {error}", file=sys.stderr, flush=True)
            return False
        for baseline, found in results(plain, method).items():
            write_text(out / f"{baseline}.json", json_text({"case": case.name, **found}))
    if plain is not None:
        print(f"{case.name}: {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
    return True


def main(arguments: Sequence[str] | None = None) -> int:
    """0 where every case was run, 1 where some could not be, 2 where the arguments are at fault."""
    options = _parsed(arguments)
    try:
        methods = _listed(options.methods, METHOD_NAMES)
        failed = run(options.cases, options.out, methods, _listed(options.only))
        rows = compared(options.keys or options.cases, options.out, options.verdicts)
    except UserError as error:
        print(error, file=sys.stderr)
        return 2
    if rows:
        write_text(options.out / "against.json", json_text([row.as_json() for row in rows]))
        write_text(options.out / "against.md", table(rows))
        print(table(rows))
    else:
        print("No key to score by: the results are there, the table is not.", file=sys.stderr)
    return int(failed > 0)


def _listed(text: str, known: Sequence[str] = ()) -> list[str]:
    """The names of a comma-separated list. Raises UserError where one is not among ``known``, if these are given."""
    names = [name.strip() for name in text.split(",") if name.strip()]
    for name in names:
        if known and name not in known:
            raise UserError(
                f"--methods: {name} is unknown{did_you_mean(name, known)}; expected some of {','.join(known)}"
            )
    return names


def _parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m experiments.concealed.against", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("cases", type=Path, metavar="CASES", help="folder of cases")
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for results")
    parser.add_argument("--verdicts", type=Path, help="folder of the tool's verdicts on the same cases")
    parser.add_argument("--keys", type=Path, help="folder with NAME/key.json, where that is not CASES")
    parser.add_argument("--methods", default=",".join(METHOD_NAMES), help="which of them, separated by commas")
    parser.add_argument("--only", default="", help="names of cases, separated by commas")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
