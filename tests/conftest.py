"""Property tests draw the same examples on every machine; `make fuzz` draws new ones each time."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True)
settings.register_profile("fuzz", print_blob=True)
settings.load_profile("repeatable")
