"""Other readings of the paper, mistakes of method among them, and the scan over their combinations."""
