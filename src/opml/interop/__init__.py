"""Readers and writers of other software's formats: CCSDS messages, SP3, CPF and SGP4's mean elements.

Throughout, `epoch` is the UTC text from which times t [s] count, `path` names a file in errors and `content`
or `text` is what it holds, and `comment` is a line for a whole message.
"""
