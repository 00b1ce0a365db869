"""Writes high_precision.csv: exact statistics at the corners of what `estimators.bounds` promises, by mpmath.

None of the forms used here is one that the package evaluates. Takes about a quarter of an hour:
`python tests/estimators/bounds/make_high_precision.py`
"""

import csv
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path

import mpmath as mp

LOOKS = (1.0, 1.001, 1.5, 4.0, 32.4, 1e3, 1e6)
COHERENCES = (1e-8, 1e-6, 0.3, 0.9, 1.0 - 1e-12)
PHASES = (0.0, 1e-6, 0.1, 2.0, 3.14159)
PAIR_LOOKS = (1.5, 4.0, 32.4)
RATIOS = (1e-4, 0.3, 1.9)
SHARES = (1e-6, 0.3, 0.97)
Row = tuple[str, float, float, float, str]


def integral(function: Callable, low, high, peak, width):
    """`function` over [low, high] in panels that grow from `width` about `peak`."""
    edges = {low, high}
    reach = width / 4
    while reach < high - low:
        edges |= {e for e in (peak - reach, peak + reach) if low < e < high}
        reach *= 3
    # The error that ends the refinement is an absolute one.
    level = max(abs(function(e)) for e in edges)
    return level * mp.quad(lambda x: function(x) / level, sorted(edges), method="gauss-legendre", maxdegree=6)


def student(n, end, below):
    """Regularised incomplete beta function of 1/2 and n + 1/2 below or above `end^2`."""
    if n <= 1000:
        if below:
            return mp.betainc(0.5, n + 0.5, 0, end**2, regularized=True)
        return mp.betainc(n + 0.5, 0.5, 0, (1 - end) * (1 + end), regularized=True)
    low, high = (mp.mpf(0), end) if below else (end, mp.mpf(1))
    width = 1 / mp.sqrt(n) if below else min(1 / mp.sqrt(n), 1 / (n * end))
    area = integral(lambda u: (1 - u * u) ** (n - mp.mpf(0.5)), low, high, low, width)
    return 2 * area / mp.beta(0.5, n + 0.5)


def phase_pdf(phi, n, g):
    """The textbook form: uniform phase, and a root of gamma power with Student's distribution."""
    # Behind the mean direction both terms nearly cancel.
    with mp.workdps(40):
        q = g**2 / ((1 - g) * (1 + g))
        cosine = mp.cos(phi)
        front = mp.sqrt(q / mp.pi) / 2 * mp.exp(mp.loggamma(n + 0.5) - mp.loggamma(n))
        front *= abs(cosine) * mp.exp(-(n + 0.5) * mp.log1p(q * mp.sin(phi) ** 2))
        part = student(n, g * abs(cosine), cosine > 0)
        uniform = mp.exp(-n * mp.log1p(q)) / (2 * mp.pi)
        return uniform + front * (1 + part) if cosine > 0 else uniform - front * part


def phase_scale(n, g):
    return min(mp.sqrt((1 - g) * (1 + g) / (2 * n)) / g, mp.mpf(1))


def phase_tail(psi, n, g):
    width = min(phase_scale(n, g), phase_scale(n, g) ** 2 / psi)
    return integral(lambda phi: phase_pdf(phi, n, g), psi, mp.pi, psi, width)


def phase_std(n, g):
    scale = phase_scale(n, g)
    return mp.sqrt(2 * integral(lambda phi: phi**2 * phase_pdf(phi, n, g), mp.mpf(0), mp.pi, mp.mpf(0), scale))


def coherence_pdf(v, rest, n, g):
    """At v and `rest = 1 - v`; `2F1(n, n; 1; z^2)` is the mean of `|1 - z exp(i a)|^-2n` over the circle."""
    z, gap = v * g, (1 - g) + g * rest
    circle = integral(
        lambda a: (1 + 4 * z * mp.sin(a / 2) ** 2 / gap**2) ** (-n), mp.mpf(0), mp.pi, mp.mpf(0), gap / mp.sqrt(n)
    )
    level = n * mp.log((1 - g) * (1 + g) / gap**2) + (n - 2) * mp.log(rest * (1 + v))
    return 2 * (n - 1) * v * mp.exp(level) * circle / mp.pi


def coherence_moments(n, g):
    """Mean and standard deviation, over `zeta = atanh(v)`, about which the peak is `1 / sqrt(2 n)` wide."""
    centre, width = mp.atanh(g), 1 / mp.sqrt(2 * n)
    low = max(mp.mpf(0), centre - 8 * mp.sqrt(5 / n) - 40 / n)
    high = centre + 8 * mp.sqrt(5 / n) + 40 / (n - 1)
    cache: dict = {}

    def rest(zeta):
        return 2 / (1 + mp.exp(2 * zeta))

    def mass(zeta):
        if zeta not in cache:
            v = mp.tanh(zeta)
            cache[zeta] = coherence_pdf(v, rest(zeta), n, g) * rest(zeta) * (1 + v)
        return cache[zeta]

    # The density adds up to one, but for n near one beyond the last panel.
    total = integral(mass, low, high, centre, width)
    missing = integral(lambda z: mass(z) * rest(z), low, high, centre, width) / total
    square = integral(lambda z: mass(z) * (rest(z) - missing) ** 2, low, high, centre, width) / total
    return total, 1 - missing, mp.sqrt(square)


def line_rule(n, ratio):
    """Phases and weights of N lines, or of their Gauss rule for real N."""
    count = int(mp.ceil(n))
    matrix = mp.zeros(count)
    for k in range(1, count):
        beside = mp.sqrt(k**2 * (1 - (k / n) ** 2) / (4 * (4 * mp.mpf(k) ** 2 - 1)))
        matrix[k, k - 1] = matrix[k - 1, k] = beside
    position, vectors = mp.eigsy(matrix)
    return [(2 * mp.pi * ratio * position[i], n * vectors[0, i] ** 2) for i in range(count)]


def coherent_pair(n, g, ratio):
    """Theory section 3, by even steps of log t: `1/2 - 1/pi int sin(sum w atan(l t)) / prod (1 + l^2 t^2)^(w/2)`."""
    with mp.workdps(60):
        roots = []
        for theta, weight in line_rule(n, ratio):
            real, square = 1 - mp.cos(theta), 4 * mp.sin(theta / 2) ** 2
            spread = mp.sqrt((g * real) ** 2 + (1 - g) * (1 + g) * square)
            roots += [((g * real + spread) / 2, weight), ((g * real - spread) / 2, weight)]
        strongest = max(abs(root) for root, _ in roots)
        step, total = mp.mpf("0.06"), mp.mpf(0)
        for i in range(-1800, 1400):
            t = mp.exp(i * step) / strongest
            angle = mp.fsum(w * mp.atan(root * t) for root, w in roots)
            fall = mp.fsum(w * mp.log1p((root * t) ** 2) for root, w in roots)
            total += mp.sin(angle) * mp.exp(-fall / 2)
        return mp.mpf(0.5) - step * total / mp.pi


def pair_rows() -> Iterator[Row]:
    for n in PAIR_LOOKS:
        for g in COHERENCES:
            for ratio in RATIOS:
                value = coherent_pair(mp.mpf(n), mp.mpf(g), mp.mpf(ratio))
                # What the even steps leave of an alternating integral.
                if value > 1e-28:
                    yield "coherent_pair", n, g, ratio, mp.nstr(value, 17)


def rows() -> Iterator[Row]:
    for n in LOOKS:
        for g in COHERENCES:
            looks, coherence = mp.mpf(n), mp.mpf(g)
            for phase in PHASES:
                yield "phase_pdf", n, g, phase, mp.nstr(phase_pdf(mp.mpf(phase), looks, coherence), 17)
            for phase in PHASES[1:]:
                yield "phase_tail", n, g, phase, mp.nstr(phase_tail(mp.mpf(phase), looks, coherence), 17)
            yield "phase_std", n, g, 0.0, mp.nstr(phase_std(looks, coherence), 17)
            if n > 1:
                for v in SHARES:
                    yield (
                        "coherence_pdf",
                        n,
                        g,
                        v,
                        mp.nstr(coherence_pdf(mp.mpf(v), 1 - mp.mpf(v), looks, coherence), 17),
                    )
                _, mean, std = coherence_moments(looks, coherence)
                yield "coherence_mean", n, g, 0.0, mp.nstr(mean, 17)
                yield "coherence_std", n, g, 0.0, mp.nstr(std, 17)


def main() -> None:
    mp.mp.dps = 22
    with Path(__file__).with_name("high_precision.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["quantity", "looks", "coherence", "argument", "value"])
        for row in chain(rows(), pair_rows()):
            writer.writerow(row)
            file.flush()


if __name__ == "__main__":
    main()
