"""Answers of servers that hold an error in the place of data, as downloads keep them under a file's name."""

import re

_KINDS = {
    "nothing": re.compile(rb"\s*\Z"),
    "an HTML page": re.compile(rb"\s*(?:<!doctype html|<html|<head|<body|<\?php)", re.IGNORECASE),
    "CelesTrak: not updated": re.compile(rb"\s*GP data has not updated", re.IGNORECASE),
    "CelesTrak: no such object": re.compile(rb"\s*No (?:Sup)?GP data found", re.IGNORECASE),
    "CelesTrak: a query that it does not know": re.compile(rb"\s*Invalid query", re.IGNORECASE),
    "Space-Track: a login that failed": re.compile(rb"""\s*\{\s*"Login"\s*:\s*"Failed""", re.IGNORECASE),
    "Space-Track: an error": re.compile(rb"""\s*\[?\s*\{\s*"error"\s*:""", re.IGNORECASE),
}
"""What begins a body, by what it is."""


def kind_of(content: bytes) -> str | None:
    """Return what a body is in words where it is an error, None where it may be data."""
    return next((kind for kind, begin in _KINDS.items() if begin.match(content)), None)
