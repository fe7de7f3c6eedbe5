"""`python -m octsim` is the command `octsim`."""

import sys

from octsim.cli.main import main

sys.exit(main())
