"""`python -m hydrohil.services.controller`."""

import sys

from hydrohil.services.controller.service import main

sys.exit(main())
