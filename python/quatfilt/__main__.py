"""``python -m quatfilt`` is the command ``quatfilt``."""

import sys

from quatfilt.cli import main

if __name__ == "__main__":
    sys.exit(main())
