"""`python -m services.supervisor`."""

import sys

from services.supervisor.service import main

sys.exit(main())
