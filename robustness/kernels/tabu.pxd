cimport cython
from robustness.kernels.passes cimport both_cores
from robustness.kernels.words cimport SOURCES, number, word

cdef word _FACTOR, _INCREMENT, _ALL_BITS

@cython.locals(k=number)
cdef void _tell(
    const long long[::1] in_indptr, const int[::1] in_indices, int[:, ::1] rise, int[:, ::1] fall, number i,
    number side, number up, number down) noexcept nogil

cdef word _draw(word state) noexcept nogil

@cython.locals(
    luck=word, n=number, inside=int[:, ::1], outside=int[::1], rise=int[:, ::1], fall=int[:, ::1], size=number[::1],
    exposed=number[::1], paying=int[::1], place=int[::1], until=number[::1], count=number, cost=number, i=number,
    k=number, a=number, b=number, c=number, t=number, x=number, y=number, best=number, step=number, u=number, v=number,
    current=number, mover=number, goal=number, gain=number, ties=number, degree=number, leave=number, change=number)
cpdef bint tabu(
    const long long[::1] in_indptr, const int[::1] in_indices, const long long[::1] out_indptr,
    const int[::1] out_indices, signed char[::1] side, signed char[::1] kind, long long[:, ::1] price, number r,
    number s, number fee, number least, number steps, number tenure, word seed, unsigned char[::1] first,
    unsigned char[::1] second)
