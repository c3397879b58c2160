"""What leaves: corrected and forecast ephemerides, and the same replayed for mornings that are over."""
