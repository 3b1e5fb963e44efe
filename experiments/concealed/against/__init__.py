"""Other ways to the same end, on the same cases: what a re-tuned model, a sparse regression and a neural residual make of them."""
