"""`python -m services.controller`."""

import sys

from services.controller.service import main

sys.exit(main())
