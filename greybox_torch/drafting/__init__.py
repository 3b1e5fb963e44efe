"""First drafts: a data card from recordings, a model file from a pattern."""
