"""Generate cases of concealed effects on the robot arm.

    python -m experiments.concealed.generate OUT [--cases 64] [--seed 0] [--effects a,b] [--samples 19838]
                                             [--two 12] [--none 12] [--outside 6] [--strength moderate]

writes OUT/NAME/{dataset.toml, estimation.csv, validation1.csv, validation2.csv, validation3.csv, key.json}. Without
--effects, `--none` cases have no effect, `--outside` one from outside the library of mechanisms, `--two` a pair, and the
others one each, going round the catalogue; --cases is the total. With --effects every case has one of those listed, in
turn ("none" and pairs "a+b" are allowed). A case depends on the seed, its number, its plan and the number of samples alone.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.case import Case, draw_case, simulate_cases
from experiments.concealed.effects import CATALOGUE, LIBRARY, OUTSIDE, STRENGTHS
from experiments.concealed.files import write_case


def draw_pair(rng: Generator) -> tuple[str, str]:
    """Two effects of different families, both from the library."""
    while True:
        first, second = (LIBRARY[i] for i in rng.choice(len(LIBRARY), 2, replace=False))
        if CATALOGUE[first].family != CATALOGUE[second].family:
            return first, second


def standard_plans(seed: int, cases: int, two: int, none: int, outside: int) -> list[tuple[str, ...]]:
    """The effects of every case, in shuffled order."""
    single = cases - two - none - outside
    if single < 0:
        raise ValueError(f"--cases {cases} is less than --two {two} + --none {none} + --outside {outside}")
    rng = np.random.default_rng(SeedSequence([seed, 0]))
    order = rng.permutation(len(LIBRARY))
    plans: list[tuple[str, ...]] = [()] * none
    plans += [(OUTSIDE[i % len(OUTSIDE)],) for i in range(outside)]
    plans += [draw_pair(rng) for _ in range(two)]
    plans += [(LIBRARY[order[i % len(LIBRARY)]],) for i in range(single)]
    return [plans[i] for i in rng.permutation(len(plans))]


def listed_plans(listed: str, cases: int) -> list[tuple[str, ...]]:
    """Plans from the --effects list, in turn."""
    choices: list[tuple[str, ...]] = []
    for word in listed.split(","):
        names = () if word == "none" else tuple(word.split("+"))
        for name in names:
            if name not in CATALOGUE:
                raise ValueError(f"--effects: no effect is called {name!r}; there are none, {', '.join(CATALOGUE)}")
        choices.append(names)
    return [choices[i % len(choices)] for i in range(cases)]


def generate(
    out: Path, plans: list[tuple[str, ...]], *, seed: int, samples: int, strength: str = "moderate", block: int = 96
) -> list[Case]:
    """Draw, simulate and write the cases, `block` cases side by side."""
    drawn: list[Case] = []
    for start in range(0, len(plans), block):
        cases = [
            draw_case(seed, number, plans[number], samples=samples, strength=strength)
            for number in range(start, min(start + block, len(plans)))
        ]
        for case, recordings in zip(cases, simulate_cases(cases), strict=True):
            write_case(out / case.name, case, recordings)
        drawn += cases
    return drawn


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--cases", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--effects", help="comma-separated names, 'none', or pairs joined by '+'")
    parser.add_argument("--samples", type=int, default=19838)
    parser.add_argument("--two", type=int, default=12)
    parser.add_argument("--none", type=int, default=12)
    parser.add_argument("--outside", type=int, default=6)
    parser.add_argument("--strength", choices=[*STRENGTHS, "drawn"], default="moderate")
    options = parser.parse_args(arguments)
    try:
        if options.effects:
            plans = listed_plans(options.effects, options.cases)
        else:
            plans = standard_plans(options.seed, options.cases, options.two, options.none, options.outside)
    except ValueError as error:
        parser.error(str(error))
    began = time.perf_counter()
    cases = generate(options.out, plans, seed=options.seed, samples=options.samples, strength=options.strength)
    for case in cases:
        print(case.name, "+".join(case.plan) or "none")
    print(f"{len(cases)} cases in {time.perf_counter() - began:.0f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
