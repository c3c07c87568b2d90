cimport cython
from robustness.kernels.shared cimport varint
from robustness.kernels.words cimport SOURCES, bit_of, count, first, number, word

cdef int P, Q, F, T, Z, NORMAL, PROPAGATE, EXCLUDE

@cython.locals(w=number, bit=word)
cpdef void assume(word[:, ::1] state, number kind, number side, number node, bint true, bint two_faces) noexcept nogil

@cython.final
cdef class TrapRules:
    cdef public word[:, ::1] hears
    cdef public number[::1] need, votes
    cdef public number[:, ::1] margin
    cdef public word[:, ::1] reach, loose, near
    cdef public number[::1] blocker, budget
    cdef public unsigned char[::1] buffer
    cdef public number n, words, f, place
    cdef public bint two_faces, local, counting

    @cython.locals(
        changed=bint, same=bint, w=number, p1=word, p2=word, q1=word, q2=word, f1=word, f2=word, t1=word, t2=word,
        z=word)
    cdef number _roles(self, word[:, ::1] state) noexcept nogil

    cdef word sure(self, word[:, ::1] state, number side, number x) noexcept nogil

    @cython.locals(total=number, x=number)
    cdef number _heard_malicious(self, word[:, ::1] state, number node) noexcept nogil

    @cython.locals(n=number, words=number, changed=bint, used=number, w=number, x=number, i=number, bit=word, lost=word)
    cdef number _budget(self, word[:, ::1] state) noexcept nogil

    @cython.locals(used=number, x=number)
    cdef number _left(self, word[:, ::1] state, number node) noexcept nogil

    @cython.locals(
        words=number, changed=bint, some=bint, w=number, x=number, i=number, inside=number, extra=number, usable=number,
        rest=word, bit=word, known=word, certain=word, wanted=word)
    cdef number _peel(self, word[:, ::1] state, number side) noexcept nogil

    @cython.locals(twice=number, spent_i=number, spent_j=number)
    cdef number _gain(
        self, number left_i, number left_j, number x, number y, number z_i, number z_j) noexcept nogil

    @cython.locals(words=number, most=number, v=number, x=number, i=number, rest=word)
    cdef number _gather_blockers(self, word[:, ::1] state, number side) noexcept nogil

    @cython.locals(
        i=number, x=number, y=number, z_i=number, z_j=number, u=number, either=word, one=word, two=word)
    cdef number _further(self, number j, number a, number left_j) noexcept nogil

    @cython.locals(
        words=number, other=number, near=word[:, ::1], reach=word[:, ::1], need=number[::1], most=number, changed=bint,
        w=number, x=number, i=number, j=number, a=number, have=number, margin=number, places=number, rest=word)
    cdef number _exclude(self, word[:, ::1] state, number side) noexcept nogil

    @cython.locals(inside=number, x=number)
    cdef number lack(self, word[:, ::1] state, number side, number node) noexcept nogil

    @cython.locals(
        n=number, words=number, v=number, w=number, x=number, i=number, side=number, total=number, missing=number,
        left=number, best=number, rest=word, open_=word)
    cdef bint _share(self, word[:, ::1] state) noexcept nogil

    @cython.locals(told=number, again=bint, side=number)
    cpdef bint propagate(self, word[:, ::1] state) noexcept nogil
