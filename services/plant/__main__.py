"""`python -m hydrohil.services.plant`."""

import sys

from hydrohil.services.plant.main import main

sys.exit(main())
