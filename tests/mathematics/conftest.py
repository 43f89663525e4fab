from hypothesis import settings

# The first example of a property compiles its kernel, and shared machines are slow at times.
settings.register_profile("no_deadline", deadline=None)
settings.load_profile("no_deadline")
