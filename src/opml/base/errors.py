"""The error that a user is meant to see."""


class InputError(Exception):
    """A wrong input, reported in one line: ``<file>: <key or row>: what was expected and found``."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(line.strip() for line in str(message).splitlines()))


class OtherContentError(InputError):
    """A file that belongs beside those that were asked for, such as a list of objects beside their sets."""
