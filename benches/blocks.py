"""Choices beside the usual one, each measured with several seeds: differences with 95 % intervals.

Seeds are blocks, choices treatments: what is left when the mean of each choice and of each seed is taken out is chance, and its variance, pooled over all choices, gives the
intervals (randomised complete block design; D. C. Montgomery, Design and Analysis of Experiments, chapter 4). * marks a difference whose interval excludes 0 also after
Bonferroni's correction for the number of choices.
"""

import statistics


def student(probability, degrees):
    """Quantile of Student's distribution (Abramowitz & Stegun 26.7.5; off by less than 0.01 from 18 degrees of freedom on)."""
    z = statistics.NormalDist().inv_cdf(probability)
    return z + (z**3 + z) / (4 * degrees) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * degrees**2)


class Blocks:
    """One figure: its values by choice, a list of one for each seed."""

    def __init__(self, values, usual):
        self.values, self.usual = values, usual
        self.seeds, self.choices = len(values[usual]), len(values)
        self.means = {name: statistics.fmean(of_seeds) for name, of_seeds in values.items()}

    def order(self):
        """The usual choice, then the others from the least on."""
        return sorted(self.values, key=lambda name: (name != self.usual, self.means[name]))

    def error(self):
        """Standard error of a difference of two choices, and its degrees of freedom."""
        of_seeds = [statistics.fmean(values) for values in zip(*self.values.values())]
        middle = statistics.fmean(of_seeds)
        chance = [
            value - self.means[name] - of_seed + middle for name, values in self.values.items() for value, of_seed in zip(values, of_seeds)
        ]
        degrees = (self.choices - 1) * (self.seeds - 1)
        return (2 * sum(c * c for c in chance) / degrees / self.seeds) ** 0.5, degrees

    def cell(self, name, digits):
        mean = f"{self.means[name]:.{digits}f}"
        if name == self.usual or self.seeds < 2:
            return mean
        difference = self.means[name] - self.means[self.usual]
        error, degrees = self.error()
        half = student(0.975, degrees) * error
        mark = "*" if abs(difference) > student(1 - 0.025 / (self.choices - 1), degrees) * error else ""
        return f"{mean} ({difference:+.{digits}f} [{difference - half:+.{digits}f}, {difference + half:+.{digits}f}]{mark})"
