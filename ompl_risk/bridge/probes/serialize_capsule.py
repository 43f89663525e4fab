"""StateSpace.serialize and deserialize with a capsule around a numpy buffer."""

import ctypes

import numpy as np
from scene import reached, report, setup, state_at


def main():
    """A state to numbers and numbers to a state, in OMPL's own layout."""
    information = setup().getSpaceInformation()
    cube = information.getStateSpace()
    capsule_new = ctypes.pythonapi.PyCapsule_New
    capsule_new.restype = ctypes.py_object
    capsule_new.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    buffer = np.zeros(3)
    state = state_at(information, 0.1, 0.2, 0.3)
    reached()
    capsule = capsule_new(buffer.ctypes.data, b"nb_handle", None)
    cube.serialize(capsule, state)
    read = buffer.tolist() == [0.1, 0.2, 0.3]
    buffer[:] = 0.4, 0.5, 0.6
    cube.deserialize(state, capsule)
    written = state[0:3] == [0.4, 0.5, 0.6]
    size = cube.getSerializationLength() == buffer.nbytes
    saw = "ok" if read and written and size else f"read {read}, written {written}, size {size}"
    report(good=read and written and size, saw=saw)


if __name__ == "__main__":
    main()
