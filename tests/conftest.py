"""How properties are tried."""

from hypothesis import settings

# The first example of a property compiles its kernel, and shared machines are slow at times.
settings.register_profile("new", deadline=None)
# A test that fails says something about the change at hand, and fails again.
settings.register_profile("same", deadline=None, derandomize=True)
settings.load_profile("same")
