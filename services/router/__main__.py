"""`python -m hydrohil.services.router`."""

import sys

from hydrohil.services.router.service import main

sys.exit(main())
