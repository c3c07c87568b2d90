cimport cython
from robustness.kernels.words cimport SOURCES, bit_of, count, number, word

@cython.locals(others=word, i=number)
cdef bint are_twins(word[::1] heard, word[::1] usable, number u, number v) noexcept nogil

@cython.locals(tail=number, head=number, k=number, u=number, v=number)
cdef bint is_like_another(
    const int[:, ::1] arcs, int[::1] options, number link, number found, number both, word[::1] heard,
    word[::1] usable) noexcept nogil
