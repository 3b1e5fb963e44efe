"""The figure of the README: the demo's recordings, measured, re-tuned and with the effect that was found.

python -m experiments.demo_figure docs/demo.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import greybox_torch as gt
from greybox_torch.demo import DATASET


def main(out: Path) -> None:
    """Diagnose the demo's data and draw what came of it."""
    data = gt.load_dataset(DATASET)
    found = gt.diagnose(gt.load_model(str(data.model)), data)
    print(found.sentence)
    found.plot().savefig(out, dpi=80)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
