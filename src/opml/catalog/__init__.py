"""What a catalogue does: simulate tracks, fit estimates to them, predict from those."""
