"""Property tests draw the same examples on every machine; `make fuzz` draws new ones each time.

How long an example takes says nothing on a loaded machine: there is no deadline.
"""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("fuzz", print_blob=True, deadline=None)
settings.load_profile("repeatable")
