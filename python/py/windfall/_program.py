"""The program `windfall`, as `pip install` brings it: the same code, words and exit codes as the one that cargo builds."""

from __future__ import annotations

import signal
import sys

from . import _windfall


def main() -> int:
    """Runs the program with this process's arguments; its exit code."""
    # Python's own handler would only note the signal; what inherits a SIGINT that is ignored goes on to ignore it.
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _windfall.run_program(["windfall", *sys.argv[1:]])
