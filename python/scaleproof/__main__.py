"""The program: ``scaleproof`` and ``python -m scaleproof``."""

from __future__ import annotations

import signal
import sys


def main() -> int:
    """Runs the program with this process's arguments: its exit code."""
    from . import _native

    # The program ends, or finishes what must not be cut off, by itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["scaleproof", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
