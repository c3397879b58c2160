"""Readers of orbits in formats that no CCSDS message has: of laser ranging, GNSS, operators and STK."""
