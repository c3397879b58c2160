"""Readers and writers of other software's formats: CCSDS messages, SP3, CPF and SGP4's mean elements."""
