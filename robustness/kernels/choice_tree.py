"""The inner loop of :mod:`robustness.mending.choice_search`: a tree of choices of links that meet all known rows.

A *row* is a demand on the links that are added (:mod:`robustness.mending.demands`): its units, in three groups A, B, C.
It is met when the worths of A and B add up to ``s``, or a unit of C is met; the worth of a group is the number of its
units that are met, or ``s`` when all are. Rows once met stay met when links are added.

A node of the tree has links that are chosen, and links that are excluded. Of the rows that are open there the one is
taken that the fewest links can serve: one of these has to be chosen. Each is tried, and excluded in those tried after
it. What is still needed at least is counted (``_least``); where that is more than the budget leaves, the node is given
up, and where all rows are met the caller is asked for a row that is not.

Node sets are single 64-bit words: at most 64 nodes. All memory is the caller's.
"""

# mypy: ignore-errors
# Types are in choice_tree.pxd, which the compiler checks.

from __future__ import annotations

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.twins import is_like_another
    from robustness.kernels.words import bit_of, count, first

__all__ = ["ChoiceTree"]

#: More than any cost.
_NEVER = 1 << 60


class ChoiceTree:
    """One search, from its root to its end, through all its pauses.

    Parameters
    ----------
    links : (into, cost, arcs, both, alike)
        ``both``: how many arcs a link brings at most; ``alike``: whether nodes that nothing in the network tells apart
        can be swapped, costs and caps included.
    budget : int
    state : (heard, usable, options, picked, spent)
        The rows of level 0 of ``heard`` and ``usable``, and the first of ``spent``, are filled in.

    Attributes
    ----------
    into : array of int32, shape (n, n)
        ``into[i, j]`` is the link that brings the arc j -> i, or -1.
    cost : array of int64, shape (links,)
    arcs : array of int32, shape (links, 4)
        Tail and head of each arc of a link, -1 for one that it does not bring.
    heard, usable : arrays of uint64, shape (levels, n)
        Whom a node hears at every level of the tree, and whom it could hear by links that are not excluded.
    options : array of int32, shape (levels, links)
        The links of which one has to be chosen there.
    picked : array of int64, shape (levels, 2)
        How many options there are, and how many were tried.
    spent : array of int64, shape (levels,)
        What the chosen links cost.
    room : array of int64, shape (n,)
        How many in-neighbours every node may gain.
    counted, served : arrays of uint64, shape (n,)
        The arcs that rows counted before use, and those of the options.
    forced : array of int64, shape (n,)
        How many more in-neighbours a node needs whatever is chosen.
    tally : array of int64, shape (n + 1,)
        Units of a row by what they miss; 0 outside :meth:`_weigh`.
    rows : array of int64, shape (rows, 7)
        Where the units of A begin, those of B, those of C, and where they end; s; whether all of A, and all of B, can
        be met.
    unit_node, unit_enough : arrays of int64, shape (units,)
    unit_outside : array of uint64, shape (units,)
        A unit is met when its node hears so many of those outside.
    opened : array of int32, shape (levels, rows)
        The rows that are open at every level.
    opened_count : array of int64, shape (levels,)
        How many these are.
    lacks, at_least, sizes : arrays of int64, shape (rows,)
        Of the open rows of one level: how many units each lacks, how many links it takes at least, and how many can
        serve it.
    supports : array of uint64, shape (rows, n)
        Those that can serve it, as arcs.
    """

    def __init__(self, links, budget, state, room, counted, served, forced, tally):
        self.into, self.cost, self.arcs, self.both, self.alike = links
        self.heard, self.usable, self.options, self.picked, self.spent = state
        self.room, self.counted, self.served, self.forced, self.tally = room, counted, served, forced, tally
        self.n, self.budget = self.into.shape[0], budget
        self.cheapest = _NEVER
        for a in range(self.cost.shape[0]):
            self.cheapest = min(self.cheapest, self.cost[a])
        self.beyond, self.nodes = _NEVER, 0
        self.level, self.is_new = 0, True
        self.need, self.largest, self.forced_total = 0, 0, 0

    def with_rows(self, rows, units, opened, opened_count, plan, supports):
        """Take the arrays of the rows, which may have grown; ``units`` and ``plan`` are three each."""
        self.rows = rows
        self.unit_node, self.unit_outside, self.unit_enough = units
        self.opened, self.opened_count = opened, opened_count
        self.lacks, self.at_least, self.sizes = plan[0], plan[1], plan[2]
        self.supports = supports
        self.largest = 0
        for unit in range(self.unit_enough.shape[0]):
            self.largest = max(self.largest, self.unit_enough[unit])

    def _missing(self, level, unit):
        """Return how many more in-neighbours a unit asks for."""
        return self.unit_enough[unit] - count(self.heard[level, self.unit_node[unit]] & self.unit_outside[unit])

    def _lacks(self, level, row):
        """Return how many further units a row asks for; 0 when it is met."""
        s = self.rows[row, 4]
        met = 0
        for unit in range(self.rows[row, 2], self.rows[row, 3]):
            if self._missing(level, unit) <= 0:
                return 0
        for group in range(2):
            inside = 0
            for unit in range(self.rows[row, group], self.rows[row, group + 1]):
                if self._missing(level, unit) <= 0:
                    inside += 1
                    if met + inside >= s:
                        return 0
            if self.rows[row, 5 + group] and inside == self.rows[row, group + 1] - self.rows[row, group]:
                return 0
            met += inside
        return s - met

    def _supply(self, level, unit):
        """Return from whom the node of a unit could hear for it."""
        i = self.unit_node[unit]
        return self.unit_outside[unit] & self.usable[level, i] & ~self.heard[level, i]

    def _weigh(self, level, row, lacks, place):
        """Write into ``supports`` what can serve an open row; return how many links it takes at least, or NEVER.

        Sets ``need`` to 1 when every unit that can be met has to be, else 0.
        """
        links, ways, all_needed = _NEVER, 0, False
        able = 0
        for i in range(self.n):
            self.supports[place, i] = 0
        for unit in range(self.rows[row, 0], self.rows[row, 3]):
            missing = self._missing(level, unit)
            if missing > 0:
                supply = self._supply(level, unit)
                if count(supply) >= missing:
                    self.supports[place, self.unit_node[unit]] |= supply
                    if unit < self.rows[row, 2]:
                        able += 1
                        self.tally[missing] += 1
                    else:
                        links = min(links, missing)
                        ways += 2
        # The partial way: of the units of A and B together those that miss least.
        total, most, taken = 0, 0, 0
        for missing in range(1, self.largest + 1):
            some = min(self.tally[missing], lacks - taken)
            if some:
                total += some * missing
                taken += some
                most = missing
            self.tally[missing] = 0
        if able >= lacks:
            links = min(links, max(most, (total + self.both - 1) // self.both))
            ways += 1
            all_needed = able == lacks
        for group in range(2):
            if self.rows[row, 5 + group] and self.rows[row, group + 1] - self.rows[row, group] < self.rows[row, 4]:
                total, most, able = 0, 0, 1
                for unit in range(self.rows[row, group], self.rows[row, group + 1]):
                    missing = self._missing(level, unit)
                    if missing > 0:
                        total += missing
                        most = max(most, missing)
                        if count(self._supply(level, unit)) < missing:
                            able = 0
                if able:
                    links = min(links, max(most, (total + self.both - 1) // self.both))
                    ways += 1
                    all_needed = self.rows[row, 1 - group] == self.rows[row, 2 - group]
        self.need = 1 if ways == 1 and all_needed else 0
        return links

    def _mirror(self, place):
        """Make a set of links in ``supports`` the same from both ends; return how many links it has."""
        size = 0
        if self.both == 2:
            for i in range(self.n):
                rest = self.supports[place, i]
                while rest:
                    self.supports[place, first(rest)] |= bit_of(i)
                    rest &= rest - 1
        for i in range(self.n):
            size += count(self.supports[place, i])
        return size // self.both

    def _drop(self, level, link):
        """Exclude a link at a level."""
        for end in range(0, 4, 2):
            if self.arcs[link, end] >= 0:
                self.usable[level, self.arcs[link, end + 1]] &= ~bit_of(self.arcs[link, end])

    def _choose(self, level, link):
        """Fill the next level with the network of this one and the link."""
        below = level + 1
        for i in range(self.n):
            self.heard[below, i] = self.heard[level, i]
            self.usable[below, i] = self.usable[level, i]
        self.spent[below] = self.spent[level] + self.cost[link]
        for end in range(0, 4, 2):
            if self.arcs[link, end] >= 0:
                self.heard[below, self.arcs[link, end + 1]] |= bit_of(self.arcs[link, end])
        for end in range(0, 4, 2):
            head = self.arcs[link, end + 1]
            if head >= 0 and count(self.heard[below, head] & ~self.heard[0, head]) >= self.room[head]:
                for j in range(self.n):
                    if self.into[head, j] >= 0:
                        self._drop(below, self.into[head, j])

    def _give_up(self, cost):
        """Note what it would have cost at least to go on here."""
        self.beyond = min(self.beyond, cost)

    def _links_left(self, level):
        """Return how many links the budget leaves at most."""
        return (self.budget - self.spent[level]) // max(self.cheapest, 1)

    def _narrow(self, level, row, lacks, found):
        """Where one link is left: narrow ``served`` to those that can serve this row too; False when none can."""
        links = self._weigh(level, row, lacks, 0)
        some = 0
        if links < 2:
            self._mirror(0)
            for j in range(self.n):
                if found:
                    self.served[j] &= self.supports[0, j]
                else:
                    self.served[j] = self.supports[0, j]
                some |= self.served[j]
        if some or links == _NEVER:
            return some != 0
        self._give_up(self.spent[level] + 2 * self.cheapest)
        return False

    def _open(self, level):
        """Fill the level's list of open rows from that above; return False when the budget is used up and one is."""
        found = 0
        above = max(level - 1, 0)
        total = self.opened_count[above]
        left = self._links_left(level)
        spent_up = left == 0
        for k in range(total):
            row = self.opened[above, k]
            lacks = self._lacks(level, row)
            if lacks:
                if spent_up:
                    # Rows that refute often are looked at first.
                    if k:
                        self.opened[above, k] = self.opened[above, k >> 1]
                        self.opened[above, k >> 1] = row
                    self._give_up(self.spent[level] + self.cheapest)
                    return False
                if left == 1 and level and not self._narrow(level, row, lacks, found):
                    self.opened[above, k] = self.opened[above, k >> 1]
                    self.opened[above, k >> 1] = row
                    return False
                self.opened[level, found] = row
                self.lacks[found] = lacks
                found += 1
        self.opened_count[level] = found
        return True

    def _weigh_all(self, level, left):
        """Find what is forced, and who can serve what is served by fewest; return that row, or -1, or -2 to give up.

        -1 stands for a node all of whose options are in ``served``. ``forced`` and ``forced_total``: how many more
        in-neighbours a node needs whatever is chosen.
        """
        best, chosen = _NEVER, -1
        self.forced_total = 0
        for i in range(self.n):
            self.forced[i] = 0
        for k in range(self.opened_count[level]):
            row = self.opened[level, k]
            links = self._weigh(level, row, self.lacks[k], k)
            if links > left:
                if links < _NEVER:
                    self._give_up(self.spent[level] + links * self.cheapest)
                return -2
            self.at_least[k] = links
            if self.need:
                for unit in range(self.rows[row, 0], self.rows[row, 2]):
                    missing = self._missing(level, unit)
                    supply = self._supply(level, unit)
                    size = count(supply)
                    if missing > 0 and size >= missing:
                        i = self.unit_node[unit]
                        if missing > self.forced[i]:
                            self.forced_total += missing - self.forced[i]
                            self.forced[i] = missing
                        if size < best:
                            best, chosen = size, -1
                            for j in range(self.n):
                                self.served[j] = 0
                            self.served[i] = supply
            self.sizes[k] = self._mirror(k)
            if not self.need and self.sizes[k] < best:
                best, chosen = self.sizes[k], row
                for j in range(self.n):
                    self.served[j] = self.supports[k, j]
        return chosen

    def _tighten(self, level, left):
        """Exclude links that serve fewer forced nodes than can be afforded; return whether there were any.

        So many links serve at most ``both`` forced nodes each, and together ``forced_total`` times.
        """
        spare = self.both * left - self.forced_total
        if spare >= self.both:
            return False
        everybody, changed = 0, False
        for i in range(self.n):
            if self.forced[i]:
                everybody |= bit_of(i)
        for i in range(self.n):
            before = self.usable[level, i]
            if self.both == 1 or (spare == 1 and not self.forced[i]):
                after = before & everybody if self.both == 2 else before if self.forced[i] else 0
            elif spare == 1:
                after = before
            else:
                after = before & everybody if self.forced[i] else 0
            if after != before:
                self.usable[level, i] = after
                changed = True
        return changed

    def _plan(self, level):
        """Write the options of a level; return False when nothing within the budget can meet the rows."""
        left = self._links_left(level)
        chosen, at_least = 0, 0
        while left > 1 or not level:
            chosen = self._weigh_all(level, left)
            if chosen == -2:
                return False
            at_least = (self.forced_total + self.both - 1) // self.both
            if at_least > left or not self._tighten(level, left):
                break
            # What was excluded here would cost more.
            self._give_up(self.budget + 1)
        for i in range(self.n):
            self.counted[i] = 0
        # Then rows that share no link with what was counted, small ones first.
        if 1 < left and at_least <= left:
            for small in range(4):
                for k in range(self.opened_count[level]):
                    if self.sizes[k] > 8 << small + small or (small and self.sizes[k] <= 2 << small + small):
                        continue
                    apart = True
                    for i in range(self.n):
                        if self.supports[k, i] and (self.forced[i] or self.supports[k, i] & self.counted[i]):
                            apart = False
                            break
                    if apart:
                        at_least += self.at_least[k]
                        for i in range(self.n):
                            self.counted[i] |= self.supports[k, i]
                        if at_least > left:
                            break
        if at_least > left:
            self._give_up(self.spent[level] + at_least * self.cheapest)
            return False
        found = 0
        for i in range(self.n):
            rest = self.served[i]
            while rest:
                j = first(rest)
                rest &= rest - 1
                link = self.into[i, j]
                if link < 0:
                    continue
                if chosen >= 0 and self.both == 2 and i < j and self.served[j] & bit_of(i) and self.into[j, i] == link:
                    continue
                if self.spent[level] + self.cost[link] > self.budget:
                    self._give_up(self.spent[level] + self.cost[link])
                    continue
                if self.alike and is_like_another(
                    self.arcs, self.options[level], link, found, self.both, self.heard[level], self.usable[level]
                ):
                    continue
                self.options[level, found] = link
                found += 1
        self.picked[level, 0], self.picked[level, 1] = found, 0
        return True

    def added(self, begin, end):
        """Take in rows that came since: those from ``begin`` on, open or not, at every level."""
        for level in range(self.level + 1):
            place = self.opened_count[level]
            for row in range(begin, end):
                self.opened[level, place] = row
                place += 1
            self.opened_count[level] = place

    def run(self, most):
        """Go on for so many nodes; return 0 at the end, 1 where all rows are met, 2 when the nodes are used up.

        After 1 the chosen links are the options picked at the levels below ``level``; with rows added it goes on.
        """
        with cython.nogil:
            return self._run(most)

    def _run(self, most):
        stop = self.nodes + most
        while True:
            if self.is_new:
                if self.nodes >= stop:
                    return 2
                self.nodes += 1
                self.is_new = False
                if self._open(self.level):
                    if not self.opened_count[self.level]:
                        self.is_new = True
                        return 1
                    if not self._plan(self.level):
                        self.picked[self.level, 0] = self.picked[self.level, 1] = 0
                else:
                    self.picked[self.level, 0] = self.picked[self.level, 1] = 0
            level = self.level
            if self.picked[level, 1] > 0:
                self._drop(level, self.options[level, self.picked[level, 1] - 1])
            if self.picked[level, 1] < self.picked[level, 0]:
                link = self.options[level, self.picked[level, 1]]
                self.picked[level, 1] += 1
                self._choose(level, link)
                self.level = level + 1
                self.is_new = True
            elif level == 0:
                return 0
            else:
                self.level = level - 1


built_from = SOURCES.decode() if cython.compiled else ""
