"""The shortlist refitted in full and ranked."""
