"""Tell how much of the package the tests reached: the total, and the files below the share that is asked for.

Fails where the total is below it.
"""

import io
import re
import sys

from coverage import Coverage


def short(table, least):
    """The lines of a table of coverage without files whose share is the least one [%] or more."""
    shares = {line: re.search(r" (\d+)%", line) for line in table.splitlines()}
    return [
        line
        for line, share in shares.items()
        if line.startswith(("Name", "TOTAL")) or (share and int(share[1]) < least)
    ]


def main():
    """Print the table of the last run; returns whether too little was reached."""
    measured = Coverage()
    measured.load()
    least = measured.get_option("report:fail_under")
    table = io.StringIO()
    total = measured.report(file=table)
    print(*short(table.getvalue(), least), sep="\n")
    if total < least:
        print(f"expected tests that reach {least:.0f} % of the package, got {total:.1f} %")
    return total < least


if __name__ == "__main__":
    sys.exit(main())
