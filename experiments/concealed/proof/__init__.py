"""The proof: cases drawn and sealed, verdicts of the tool frozen, the seal opened, hits and misses printed."""
