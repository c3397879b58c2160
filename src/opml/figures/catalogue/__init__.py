"""Figures of what a catalogue teaches."""
