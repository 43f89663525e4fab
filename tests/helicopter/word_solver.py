"""An independent way to the least duration between two vertices: root finding, word by word."""

import math

import numpy as np


class Solver:
    """Least durations by root finding over the heading of the straight flight, word by word.

    Knows displacements of manoeuvres and arcs, and neither the closed form nor its tables.
    """

    grid = np.linspace(-math.pi, math.pi, 1441)

    def __init__(self, library):
        self.library = library

    def words(self, k):
        """Turn words at a speed: rates, and which of them is held."""
        hard_right, right, left, hard_left = self.library.turns[k].tolist()
        for rate in (hard_right, right, left, hard_left):
            yield (rate,), 0
        for first, second in ((right, left), (left, right)):
            yield (first, second), 0
            yield (first, second), 1

    def manoeuvres(self, k, rates):
        level = (float(self.library.speeds[k]), 0.0, 0.0)
        for rate in rates:
            turn = (level[0], 0.0, rate)
            yield self.library.manoeuvre(level, turn), self.library.manoeuvre(turn, level)

    def block(self, k, word, turn):
        """Displacement and duration of a word that changes the heading by turn, an array."""
        rates, held = word
        pairs = list(self.manoeuvres(k, rates))
        least = sum(m.displacement[3] for pair in pairs for m in pair)
        rate = rates[held]
        more = np.mod((turn - least) * np.sign(rate), 2.0 * math.pi)
        hold = more / abs(rate)
        allowed = math.inf
        if len(rates) == 2:
            allowed = 2.0 * abs(sum(m.displacement[3] for m in pairs[held])) / abs(rate)
        place, heading, time = 0.0, 0.0 * turn, np.where(hold <= allowed, hold, np.inf)
        for at, (entry, leave) in enumerate(pairs):
            for m, is_entry in ((entry, True), (leave, False)):
                place = place + np.exp(1j * heading) * complex(*m.displacement[:2])
                heading = heading + m.displacement[3]
                time = time + m.duration
                if is_entry and at == held:
                    arc = self.library.speeds[k] * (np.exp(1j * rate * hold) - 1.0) / (1j * rate)
                    place = place + np.exp(1j * heading) * arc
                    heading = heading + rate * hold
        return place, time

    def straight(self, i, j, s, rise):
        """Least duration of the straight flight over the cruise speeds, and its gentlest climb."""
        library, best = self.library, math.inf
        for k, v in enumerate(library.speeds.tolist()):
            if v == 0.0:
                continue
            level, length, time = (v, 0.0, 0.0), 0.0, 0.0
            for u, w in ((i, k), (k, j)):
                if u != w:
                    keys = [(float(library.speeds[n]), 0.0, 0.0) for n in (u, w)]
                    change = library.manoeuvre(*keys)
                    length += change.displacement[0]
                    time += change.duration
            for climb in sorted(library.climbs[k].tolist(), key=abs):
                pair = [(level, (v, climb, 0.0)), ((v, climb, 0.0), level)]
                made = [library.manoeuvre(*keys) for keys in pair]
                back = [(level, (v, -climb, 0.0)), ((v, -climb, 0.0), level)]
                if climb * rise <= 0.0:
                    continue
                hold = (rise - sum(m.displacement[2] for m in made)) / climb
                if hold < 0.0:
                    if abs(climb) > 2.0:
                        continue
                    made += [library.manoeuvre(*keys) for keys in back]
                    rest = rise - sum(m.displacement[2] for m in made)
                    hold = rest / (climb if rest * climb >= 0.0 else -climb)
                over = length + sum(m.displacement[0] for m in made) + v * hold
                if over <= s:
                    spent = sum(m.duration for m in made) + hold
                    best = min(best, time + spent + (s - over) / v)
                    break  # the gentlest that fits
        return best

    def least(self, a, b):
        i, j = int(a[4]), int(b[4])
        p = np.exp(-1j * a[3]) * complex(*(b - a)[:2])
        turn, best = b[3] - a[3], math.inf
        for one in self.words(i):
            for two in self.words(j):
                for psi in self.roots(i, one, j, two, p, turn):
                    d1, t1 = self.block(i, one, psi)
                    d2, t2 = self.block(j, two, turn - psi)
                    s = (np.exp(-1j * psi) * (p - d1) - d2).real
                    best = min(best, t1 + t2 + self.straight(i, j, s, b[2] - a[2]))
        return best

    def roots(self, i, one, j, two, p, turn):
        """Headings at which what is left between the blocks lies straight ahead."""

        def aside(psi):
            d1, d2 = self.block(i, one, psi)[0], self.block(j, two, turn - psi)[0]
            return np.exp(-1j * psi) * (p - d1) - d2

        left = aside(self.grid)
        values = left.imag
        change = np.flatnonzero((values[:-1] * values[1:] <= 0.0) & (left.real[:-1] > -5.0))
        for k in change:
            low, high = self.grid[k], self.grid[k + 1]
            at_low = values[k]
            for _ in range(60):
                middle = np.array(0.5 * (low + high))
                value = aside(middle).imag
                low, high = (middle, high) if value * at_low > 0.0 else (low, middle)
            if abs(aside(middle).imag) < 1e-6 and aside(middle).real >= 0.0:
                yield float(middle)
