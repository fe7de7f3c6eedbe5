"""`python -m octsim` is the command `octsim`."""

import sys

from octsim.command import main

sys.exit(main())
