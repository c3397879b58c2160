"""Other readings of the paper, some of them mistakes of method, and the scan over their combinations."""
