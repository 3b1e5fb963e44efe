"""Generate cases of concealed effects: the standard set of the robot arm, or fresh cases on the machines of the proof.

    python -m experiments.concealed.generate OUT [--cases 64] [--seed 0] [--effects a,b] [--samples 19838]
                                             [--two 12] [--none 12] [--outside 6] [--strength moderate]
    python -m experiments.concealed.generate OUT --family mujoco [--cases 12] [--seed 0] [--effects a,b] [--strength drawn] [--workers 2]

The standard set:

writes OUT/NAME/{dataset.toml, estimation.csv, validation1.csv, validation2.csv, validation3.csv, key.json}. Without
--effects, `--none` cases have no effect, `--outside` one from outside the library of mechanisms, `--two` a pair, and the
others one each, going round the catalogue; --cases is the total. With --effects every case has one of those listed, in
turn ("none" and pairs "a+b" are allowed). A case depends on the seed, its number, its plan and the number of samples alone.

With --family (mujoco, own, or the name of one machine of `machines/`) the cases are as in the proof, keys beside: 12 by default, effects
going round, one case in four without, strengths weak, moderate, dominant, overwhelming (encoder-grade noise), or drawn.
With --family workshop they are on nine machines of everyday, which are in no proof; what is concealed is drawn.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from numpy.random import Generator, SeedSequence

from experiments.concealed.case import Case, draw_case, simulate_cases
from experiments.concealed.catalogue.arm import CATALOGUE, LIBRARY, OUTSIDE
from experiments.concealed.effects import STRENGTHS
from experiments.concealed.files import write_case
from experiments.concealed.proof.errors import ProofError


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
    choices = listed_effects(listed)
    for name in (name for names in choices for name in names):
        if name not in CATALOGUE:
            raise ValueError(f"--effects: no effect is called {name!r}; there are none, {', '.join(CATALOGUE)}")
    return [choices[i % len(choices)] for i in range(cases)]


def listed_effects(listed: str) -> list[tuple[str, ...]]:
    """What the words of an --effects list mean: "none", a name, or a pair "a+b"."""
    return [() if word == "none" else tuple(word.split("+")) for word in listed.split(",") if word]


WORKSHOP = "workshop"


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
    parser = _parser()
    options = parser.parse_args(arguments)
    try:
        if options.family:
            return _fresh(options)
        count = 64 if options.cases is None else options.cases
        if options.effects:
            plans = listed_plans(options.effects, count)
        else:
            plans = standard_plans(options.seed, count, options.two, options.none, options.outside)
        if options.strength not in (*STRENGTHS, "drawn"):
            raise ValueError(
                f"--strength {options.strength}: not of the standard set; expected {', '.join(STRENGTHS)} or drawn"
            )
    except (ValueError, ProofError) as error:
        parser.error(str(error))
    began = time.perf_counter()
    cases = generate(options.out, plans, seed=options.seed, samples=options.samples, strength=options.strength)
    for case in cases:
        print(case.name, "+".join(case.plan) or "none")
    print(f"{len(cases)} cases in {time.perf_counter() - began:.0f} s", file=sys.stderr)
    return 0


def _fresh(options: argparse.Namespace) -> int:
    from experiments.concealed.fresh import fresh_plans, write_fresh

    count = 12 if options.cases is None else options.cases
    if options.family == WORKSHOP:
        from experiments.concealed.workshop.draw import write_workshop

        chosen = listed_effects(options.effects or "")
        write_workshop(options.seed, count, options.out, effects=chosen, strength=options.strength, tell=print)
        return 0
    effects = listed_effects(options.effects or "")
    planned = fresh_plans(options.family, options.seed, count, effects=effects, strength=options.strength)
    write_fresh(
        planned, options.seed, options.out, workers=options.workers, progress=lambda text: print(text, file=sys.stderr)
    )
    for number, plan in enumerate(planned):
        print(f"c{number:03d}", plan.machine, "+".join(plan.plan) or "none", " ".join(plan.words))
    return 0


def _parser() -> argparse.ArgumentParser:
    from experiments.concealed.fresh import FAMILIES
    from experiments.concealed.scaling import WORDS

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument(
        "--family", choices=[*FAMILIES, WORKSHOP], metavar="FAMILY", help=", ".join([*FAMILIES, WORKSHOP])
    )
    parser.add_argument("--cases", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--effects", help="comma-separated names, 'none', or pairs joined by '+'")
    parser.add_argument("--samples", type=int, default=19838, help="of the standard set")
    parser.add_argument("--two", type=int, default=12, help="of the standard set")
    parser.add_argument("--none", type=int, default=12, help="of the standard set")
    parser.add_argument("--outside", type=int, default=6, help="of the standard set")
    parser.add_argument("--strength", choices=[*WORDS, "drawn"], default="moderate")
    parser.add_argument("--workers", type=int, default=2, help="processes, of --family")
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
