"""`python -m hydrohil.services.supervisor`."""

import sys

from hydrohil.services.supervisor.service import main

sys.exit(main())
