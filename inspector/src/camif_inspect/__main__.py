"""`python -m camif_inspect`."""

import sys

from .command_line import main

sys.exit(main())
