"""Settings and fixtures that all tests share."""

import os
import signal

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "short", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow], max_examples=60
)
settings.register_profile(
    "long", deadline=None, suppress_health_check=[HealthCheck.too_slow], max_examples=2000, print_blob=True
)
settings.load_profile(os.environ.get("COMMINUTE_HYPOTHESIS", "short"))


@pytest.fixture(autouse=True, scope="session")
def ctrl_c_is_heard() -> None:
    """Ctrl-C as at a terminal: a run that a shell started in the background would ignore it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
