"""Into and out of the ecosystem: CCSDS's orbit and tracking messages, and mean elements of SGP4."""
