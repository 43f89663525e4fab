"""OMPL's log is not what these tests are about."""

import pytest
from ompl import util as ou


@pytest.fixture(autouse=True)
def silence():
    level = ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)
    yield
    ou.setLogLevel(level)
