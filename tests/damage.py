"""Files from elsewhere, damaged at random: cut short, or with a bit, a digit, a word or a line changed."""

import re

from hypothesis import strategies as st

FRAGMENTS = ["", " ", "\n", "\t", "nan", "inf", "-1", "1e400", "9" * 30, "0x1F", "é", "\0", ",", "'", "{"]
PIECES = {"word": rb"[^\s=]+", "line": rb"[^\n]*\n", "digit": rb"\d"}
"""Patterns of what another text may stand in place of."""

PLACES = st.floats(0.0, 1.0)
DAMAGES = st.one_of(
    st.tuples(st.just("cut"), PLACES, st.none()),
    st.tuples(st.just("flip"), PLACES, st.integers(0, 7)),
    st.tuples(st.just("swap"), PLACES, PLACES),
    *(st.tuples(st.just(piece), PLACES, st.sampled_from(FRAGMENTS)) for piece in ("word", "line")),
    st.tuples(st.just("digit"), PLACES, st.sampled_from("0123456789")),
)
"""What is done, where (a share of the file), and with what."""


def damaged(content, how, where, what):
    """A file's bytes with a damage."""
    if how == "cut":
        return content[: int(where * len(content))]
    if how == "flip":
        changed = bytearray(content)
        changed[int(where * (len(content) - 1))] ^= 1 << what
        return bytes(changed)
    if how == "swap":
        lines = content.splitlines(keepends=True)
        one, other = (int(place * (len(lines) - 1)) for place in (where, what))
        lines[one], lines[other] = lines[other], lines[one]
        return b"".join(lines)
    parts = list(re.finditer(PIECES[how], content))
    part = parts[int(where * (len(parts) - 1))]
    return content[: part.start()] + what.encode() + content[part.end() :]
