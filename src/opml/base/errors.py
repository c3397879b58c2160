"""The error that a user is meant to see."""


class InputError(Exception):
    """A wrong input, told in one line: ``<file>: <key or row>: what was expected and found``."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(str(message).split()))
