"""`python -m services.plant`."""

import sys

from services.plant.main import main

sys.exit(main())
