cimport cython
from robustness.kernels.twins cimport is_like_another
from robustness.kernels.words cimport SOURCES, bit_of, count, first, number, word

cdef number _NEVER

@cython.final
cdef class ChoiceTree:
    cdef const int[:, ::1] into, arcs
    cdef const long long[::1] cost
    cdef word[:, ::1] heard, usable, supports
    cdef int[:, ::1] options, opened
    cdef long long[:, ::1] picked
    cdef long long[::1] spent, room, forced, opened_count, tally, lacks, at_least, sizes
    cdef long long[:, ::1] rows
    cdef long long[::1] unit_node, unit_enough
    cdef word[::1] unit_outside, counted, served
    cdef number n, budget, both, cheapest, need, largest, forced_total
    cdef public number beyond, nodes, level
    cdef bint is_new, alike

    @cython.locals(unit=number)
    cpdef void with_rows(self, rows, units, opened, opened_count, plan, supports)

    cdef number _missing(self, number level, number unit) noexcept nogil

    @cython.locals(s=number, met=number, unit=number, group=number, inside=number)
    cdef number _lacks(self, number level, number row) noexcept nogil

    @cython.locals(i=number)
    cdef word _supply(self, number level, number unit) noexcept nogil

    @cython.locals(
        links=number, ways=number, all_needed=bint, total=number, most=number, able=number, missing=number, unit=number,
        group=number, i=number, supply=word, taken=number, some=number)
    cdef number _weigh(self, number level, number row, number lacks, number place) noexcept nogil

    @cython.locals(size=number, i=number, rest=word)
    cdef number _mirror(self, number place) noexcept nogil

    @cython.locals(end=number)
    cdef void _drop(self, number level, number link) noexcept nogil

    @cython.locals(below=number, i=number, j=number, end=number, head=number)
    cdef void _choose(self, number level, number link) noexcept nogil

    cdef void _give_up(self, number cost) noexcept nogil

    cdef number _links_left(self, number level) noexcept nogil

    @cython.locals(links=number, some=word, j=number)
    cdef bint _narrow(self, number level, number row, number lacks, number found) noexcept nogil

    @cython.locals(found=number, above=number, total=number, k=number, row=number, spent_up=bint, lacks=number, left=number)
    cdef bint _open(self, number level) noexcept nogil

    @cython.locals(
        best=number, chosen=number, i=number, j=number, k=number, row=number, lacks=number, links=number, unit=number,
        missing=number, supply=word, size=number, some=word)
    cdef number _weigh_all(self, number level, number left) noexcept nogil

    @cython.locals(spare=number, everybody=word, changed=bint, i=number, before=word, after=word)
    cdef bint _tighten(self, number level, number left) noexcept nogil

    @cython.locals(
        left=number, at_least=number, i=number, j=number, k=number, small=number, chosen=number, apart=bint,
        found=number, rest=word, link=number)
    cdef bint _plan(self, number level) noexcept nogil

    @cython.locals(level=number, place=number, row=number)
    cpdef void added(self, number begin, number end)

    cpdef number run(self, number most)

    @cython.locals(stop=number, level=number, link=number)
    cdef number _run(self, number most) noexcept nogil
