cimport cython
from robustness.kernels.words cimport bit_of, SOURCES, count, first, number, word

cdef number varint(unsigned char[::1] buffer, number place, number value) noexcept nogil

@cython.locals(row=number, w=number)
cdef void copy_state(word[:, ::1] target, word[:, ::1] source) noexcept nogil

@cython.locals(words=number, w=number, x=number, i=number, inside=number, rest=word, changed=bint, some=bint)
cdef bint core(word[:, ::1] hears, number[::1] need, word[::1] candidates, word[::1] support) noexcept nogil

@cython.locals(found=number, w=number, x=number, v=number, worth=number, place=number, rest=word)
cdef number most_promising(
    word[:, ::1] hears, number[:, ::1] margin, word[:, ::1] state, number possible, number certain, number side,
    number[::1] value, number[::1] chosen) noexcept nogil
