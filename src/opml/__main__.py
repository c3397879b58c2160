"""The command as it is started: an interrupt ends it in one line, while modules are imported, too."""

import os
import signal
import sys
from types import FrameType

INTERRUPTED = 130  # exit code, as of a shell's commands

_WHOLE = "what is written is whole"
_TOLD = "opml: interrupted; {}\n"
_IMPORTS = "<frozen importlib._bootstrap>"  # file of the frames of an import


def _interrupt(number: int, frame: FrameType | None) -> None:
    while frame:
        # Compiled modules whose import fails print tracebacks of their own.
        if frame.f_code.co_filename == _IMPORTS:
            os.write(2, _TOLD.format(_WHOLE).encode())
            os._exit(INTERRUPTED)
        frame = frame.f_back
    raise KeyboardInterrupt


def main() -> int:
    """Run the command; return its exit code, INTERRUPTED after one line where its user stops it."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # it may be ignored
        signal.signal(signal.SIGINT, _interrupt)
    try:
        from opml import cli

        return cli.main()
    except KeyboardInterrupt as end:
        sys.stderr.write(_TOLD.format(str(end) or _WHOLE))
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
