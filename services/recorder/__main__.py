"""`python -m hydrohil.services.recorder`."""

import sys

from hydrohil.services.recorder.service import main

sys.exit(main())
