"""What the library promises, measured beside its peers in the same run.

``python -m benchmarks`` runs everything, ``--quick`` in under a minute.
"""
