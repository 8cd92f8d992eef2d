"""The command ``heelstrike``, as the wheel installs it."""

import signal
import sys

from . import _core


def main() -> int:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _core.main(sys.argv)
