"""Many machines of one model estimated in one batch: the same iterations as one by one, the passes of all together."""
