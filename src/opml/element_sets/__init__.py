"""Public sets of mean elements made better by what a catalogue teaches: paired, corrected, written back."""
