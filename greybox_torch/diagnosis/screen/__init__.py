"""Which hypotheses are worth a refit: a score test of every mechanism at every port, and the shortlist from it."""
