"""Compiled inner loops: functions on floats and contiguous arrays, no objects, no validation.

Callers outside validate; a kernel trusts its arguments. Imports numpy, numba and math only.
"""
