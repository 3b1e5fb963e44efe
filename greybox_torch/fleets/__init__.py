"""Many machines: finding their cards, sharing out the work, keeping what is done, and what the whole of them shows.

The package is not called `fleet`, because `greybox_torch.fleet` is the public function.
"""
