"""What the files in a folder of results are called."""

from __future__ import annotations

VERDICT, FIT, TRAINED = "verdict.json", "fit.json", "train.json"
"""What `diagnose`, `fit` and `train` come to."""

MODEL = "model"
"""The checkpoint that each of them leaves, without the endings of its two files."""

REPORT, PRINTED = "report.html", "report.pdf"

HYPOTHESES, RIVALS = "hypotheses.json", "hypotheses"
"""The hypotheses of a diagnosis, and the folder of the rivals' checkpoints, where there are any."""

OF_A_DIAGNOSIS = (VERDICT, REPORT, f"{MODEL}.json", f"{MODEL}.safetensors", HYPOTHESES)
"""The files that every diagnosis leaves."""
