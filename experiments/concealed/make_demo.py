"""Make the data set of the demo: a short recording of the arm with backlash in its gear.

    python -m experiments.concealed.make_demo [FOLDER]

writes dataset.toml, three recordings and key.json, by default into greybox_torch/demo. Always the same files.
"""

from __future__ import annotations

import sys
from pathlib import Path

from experiments.concealed.case import draw_case, simulate_cases
from experiments.concealed.files import write_case

SEED = 214  # half gap 0.040 rad, three reversals
SAMPLES = 4000
SAMPLE_TIME = 0.001  # s
EXPERIMENTS = {"estimation": "Square speed profile", "validation2": "Around rest", "validation3": "Slow sweep"}


def make_demo(folder: Path) -> None:
    """Simulate and write the demo's data set."""
    case = draw_case(SEED, 0, ("backlash",), samples=SAMPLES, sample_time=SAMPLE_TIME)
    write_case(folder, case, simulate_cases([case])[0], name="Demo: a robot arm drive", chosen=EXPERIMENTS)


if __name__ == "__main__":
    demo = Path(__file__).parents[2] / "greybox_torch" / "demo"
    make_demo(Path(sys.argv[1]) if len(sys.argv) > 1 else demo)
