"""The search: which effects the data ask for, one step at a time."""
