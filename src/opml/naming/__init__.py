"""The grammar of file names: writers and readers of every part of a product's name.

* RSO: the row of the sheet, ``iss``; with another inclination in degrees, ``iss_i50``; with kilometres added
  to its semi-major axis, ``iss_a+50``; with both, ``iss_i50_a+50``.
* Station set: the stations' names joined by '-' in the sheet's order, ``eglin-kaena``.
* Split, the rows of a dataset for training or testing: ``random-80``, ``grouped-80``, ``days-0-30``,
  ``days-30-40-unseen``, ``rest``, ``seen``. A test's treatment of its rows follows: ``days-30-40-unfenced``,
  ``days-30-40-fence3``.

A suffix stands for one setting that differs from the run's; the run's own setting has no suffix. So no
product has two names:

* ``eglin_noise43``: Eglin's measurements under another seed; ``random-80_split43``: another draw of a split.
* ``eglin_w24``: estimates from 24 hours of tracks.
* ``_later``: errors against later estimates; without a suffix, against the truth.
"""

from opml.naming.estimates import *
from opml.naming.experiment import *
from opml.naming.objects import *
from opml.naming.row_splits import *
from opml.naming.spelling import *
