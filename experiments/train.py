"""Train hybrids of one data set with several seeds, by the public interface alone.

    python -m experiments.train DATASET.toml [--net friction|residual] [--port PORT] [--signals speed,load] [--seeds 5]

prints a line a seed: mean squared error of the estimation experiments before and after, and of the free run on the held-out stretches.
Scores on the validation experiments are what `greybox train` prints; here nothing is chosen by them.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from greybox_torch import TrainingSettings, load_dataset, load_model, train_hybrid


def main(arguments: list[str] | None = None) -> int:
    chosen = _parsed(arguments)
    data = load_dataset(chosen.dataset)
    name = chosen.model or data.model
    if name is None:
        print(f"{chosen.dataset}: [model] name is missing and no --model is given", file=sys.stderr)
        return 2
    signals = tuple(chosen.signals.split(",")) if chosen.signals else ()
    print(
        f"{'seed':>4} {'seconds':>8} {'physics':>10} {'hybrid':>10} {'held out: physics':>18} {'hybrid':>10}  penalty"
    )
    after = []
    for seed in range(chosen.seeds):
        found = train_hybrid(
            data,
            load_model(name),
            net=chosen.net,
            port=chosen.port,
            signals=signals,
            network={"units": chosen.units},
            settings=TrainingSettings(seed=seed, freeze_physics=chosen.freeze_physics),
        )
        alone, best = found.polished.choices[0], found.polished.chosen
        penalty = "physics alone" if best.weight is None else f"{best.weight:g}"
        after.append(found.result.mse)
        print(
            f"{seed:4} {found.seconds:8.1f} {found.physics.mse:10.5g} {found.result.mse:10.5g} {alone.held_out:18.5g} "
            f"{best.held_out:10.5g}  {penalty}",
            flush=True,
        )
    print(f"hybrid over {len(after)} seeds: mean {np.mean(after):.5g}, spread {np.std(after):.2g}")
    return 0


def _parsed(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--model", help="wins over the model in the card")
    parser.add_argument("--net", default="friction", help="friction or residual")
    parser.add_argument("--port", help="where; the driving body by default")
    parser.add_argument("--signals", help="what it reads, separated by commas")
    parser.add_argument("--units", type=int, default=8)
    parser.add_argument("--freeze-physics", action="store_true")
    parser.add_argument("--seeds", type=int, default=1)
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
