"""Writes study_statistics_numbers.h: what scipy and numpy make of a few lists of numbers.

study_statistics_numbers.py FILE            writes it
study_statistics_numbers.py --check FILE    fails where FILE says something else; exit code 77: no scipy here"""
import re
import sys

try:
    import numpy as np
    from scipy import special, stats
except ImportError as missing:
    print(f"skipped: {sys.executable} has no {missing.name}")
    sys.exit(77)

random = np.random.default_rng(20)
first = np.round(random.gamma(3.0, 2.0, 23), 3)
second = np.round(0.8 * first + random.normal(0.5, 1.0, 23), 3)
third = np.round(random.integers(0, 6, 23) + 0.0, 3)  # with ties
numbers = {}

# one list
numbers["kQuartiles"] = np.percentile(first, [25, 50, 75], method="linear")
numbers["kTenths"] = np.percentile(first, [10, 90], method="linear")
numbers["kMean"] = [first.mean()]
numbers["kDeviation"] = [first.std(ddof=1)]

# pairs
difference = first - second
n, s = len(difference), difference.std(ddof=1)
numbers["kPairedMean"] = [difference.mean()]
numbers["kPairedInterval"] = stats.t.interval(0.95, n - 1, difference.mean(), stats.sem(difference))
numbers["kPairedMedian"] = [np.median(difference)]
z = stats.norm.ppf(0.975)
limits = difference.mean() + np.array([-1, 1]) * z * s
reach = stats.t.ppf(0.975, n - 1) * s * np.sqrt(1 / n + z**2 / (2 * (n - 1)))
numbers["kLimits"] = limits
numbers["kLimitIntervals"] = [limits[0] - reach, limits[0] + reach, limits[1] - reach, limits[1] + reach]
numbers["kPairedDz"] = [stats.ttest_rel(first, second).statistic / np.sqrt(n)]  # t = d_z sqrt(n)
numbers["kCohenD"] = [stats.ttest_ind(first, second[:15]).statistic / np.sqrt(23 * 15 / (23 + 15))]
numbers["kHedges"] = [special.gamma(m / 2) / (np.sqrt(m / 2) * special.gamma((m - 1) / 2)) for m in (2, 5, 22, 36)]

# influence
numbers["kSpearman"] = [stats.spearmanr(first, second).statistic, stats.spearmanr(third, second).statistic]
numbers["kRanks"] = stats.rankdata(third)
columns = np.column_stack([stats.zscore(x, ddof=1) for x in (first, third, first * third)])
output = stats.zscore(second, ddof=1)
coefficients, _, _, _ = np.linalg.lstsq(columns, output, rcond=None)
numbers["kRegression"] = coefficients
numbers["kRSquared"] = [1 - np.sum((output - columns @ coefficients) ** 2) / np.sum(output**2)]

# bootstrap of Sobol indices, in plain doubles and in the order that the library promises: the same bits


def mt19937_64(seed):
    """Matsumoto's and Nishimura's generator of 64 bits."""
    mask = (1 << 64) - 1
    state = [seed]
    for i in range(1, 312):
        state.append((6364136223846793005 * (state[-1] ^ (state[-1] >> 62)) + i) & mask)
    while True:
        for i in range(312):
            x = (state[i] & 0xFFFFFFFF80000000) | (state[(i + 1) % 312] & 0x7FFFFFFF)
            state[i] = state[(i + 156) % 312] ^ (x >> 1) ^ (0xB5026F5AA96619E9 if x & 1 else 0)
        for x in state:
            x ^= (x >> 29) & 0x5555555555555555
            x ^= (x << 17) & 0x71D67FFFEDA60000
            x ^= (x << 37) & 0xFFF7EEE000000000
            yield x ^ (x >> 43)


def sobol(rows):
    values = squares = products = steps = squared_steps = 0.0
    for a, b, ab in rows:
        step = ab - a
        values += a + b
        squares += a * a + b * b
        products += b * step
        steps += step
        squared_steps += step * step
    n = float(len(rows))
    mean = values / (2 * n)
    variance = squares / (2 * n) - mean * mean
    return (products - mean * steps) / (variance * n), squared_steps / (2 * variance * n)


def between(values, low, high):
    values = sorted(values)
    ranks = [f * (len(values) - 1) for f in (low, high)]
    return [values[int(r)] + (r - int(r)) * (values[min(int(r) + 1, len(values) - 1)] - values[int(r)]) for r in ranks]


N = 20  # rows; two factors
outputs = [float(x) for x in np.round(random.normal(3.0, 1.0, 4 * N), 2)]
indices = []
for i in range(2):
    rows = [(outputs[j], outputs[N + j], outputs[(i + 2) * N + j]) for j in range(N)]
    mean = 0.0
    for a, b, _ in rows:
        mean += a + b
    mean /= 2 * N
    rows = [(a - mean, b - mean, ab - mean) for a, b, ab in rows]
    draws = mt19937_64(7)
    resamples = [sobol([rows[next(draws) % N] for _ in rows]) for _ in range(50)]
    indices += [*sobol(rows)]
    for k in range(2):
        indices += between([r[k] for r in resamples], 0.5 * (1 - 0.95), 0.5 * (1 + 0.95))
numbers["kBootstrapped"] = indices  # per factor: first, total, interval of first, interval of total

LINE = "inline constexpr double {}[] = {{{}}};"
head = ["// Written by study_statistics_numbers.py: scipy's and numpy's answers. Not to be edited.", "#pragma once", "",
        "// clang-format off", "namespace dea::test {", ""]
lists = {"kFirst": first, "kSecond": second, "kThird": third, "kDesign": outputs}
lines = [LINE.format(name, ", ".join(repr(float(x)) for x in values)) for name, values in {**lists, **numbers}.items()]
text = "\n".join(head + lines + ["", "}  // namespace dea::test", ""])


def values_in(header):
    return {name: [float(x) for x in values.split(",")]
            for name, values in re.findall(r"double (\w+)\[\] = \{(.*)\};", header)}


if sys.argv[1] != "--check":
    with open(sys.argv[1], "w") as file:
        file.write(text)
    sys.exit()
with open(sys.argv[2]) as file:
    found, expected = values_in(file.read()), values_in(text)
wrong = [name for name in expected if len(found.get(name, [])) != len(expected[name])
         or not np.allclose(found[name], expected[name], rtol=1e-11, atol=1e-13)]
print(f"not scipy's: {', '.join(wrong)}" if wrong else f"{len(expected)} lists are scipy's")
sys.exit(bool(wrong or set(found) - set(expected)))
