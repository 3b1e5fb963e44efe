"""What held-out experiments say of what was found."""
