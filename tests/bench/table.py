"""Lines of figure, program, value and unit to a table: table.py RESULTS

A line that comes again is another round. Of each figure the first program is ours; a ratio is the median over rounds
of a program's time divided by ours of the same round, so above 1 ours is faster. Spread is the largest less the
smallest, in percent of the median."""
import math
import re
import statistics
import sys

TIMES = ("ms", "us")


def read(path):
    """{figure: {(program, unit): [values]}}, both in the order of their first line."""
    figures = {}
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            figure, program, value, unit = line.rstrip("\n").split("\t")
            figures.setdefault(figure, {}).setdefault((program, unit), []).append(float(value))
    return figures


def number(value):
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def rows_of(figure, programs):
    """One row a program: its first unit with ratio and spread, its peak memory, and what else it said."""
    first = next(iter(programs))
    for program in dict.fromkeys(program for program, _ in programs):
        said = {unit: values for (p, unit), values in programs.items() if p == program}
        memory = said.pop("MB", None)
        peak = f"{statistics.median(memory):,.1f}" if memory else ""
        also = ", ".join(f"{number(statistics.median(values))} {unit}" for unit, values in list(said.items())[1:])
        if not said:
            yield figure, program, "", "", "", peak, ""
            continue
        unit, values = next(iter(said.items()))
        middle = statistics.median(values)
        of_round = [value / ours for value, ours in zip(values, programs[first])]
        ratio = f"{statistics.median(of_round):.2f}" if unit == first[1] else ""
        spread = f"{100 * (max(values) - min(values)) / middle:.0f} %"
        yield figure, program, f"{number(middle)} {unit}", ratio, spread, peak, also


def show(head, rows):
    widths = [max(len(row[c]) for row in [head, *rows]) for c in range(len(head))]
    for row in [head, ["-" * width for width in widths], *rows]:
        cells = [cell.ljust(w) if c in (0, 1, 6) else cell.rjust(w) for c, (cell, w) in enumerate(zip(row, widths))]
        print("| " + " | ".join(cells) + " |")


def slope(points):
    """Of the least-squares line through the logarithms: 1 is a cost in proportion, 2 one that quadruples with twice."""
    x = [math.log(size) for size, _ in points]
    y = [math.log(value) for _, value in points]
    return statistics.linear_regression(x, y).slope


def growths(figures):
    series = {}
    for figure, programs in figures.items():
        sized = re.fullmatch(r"(.*)=(\d+)", figure)
        for (program, unit), values in programs.items() if sized else ():
            point = (int(sized[2]), statistics.median(values))
            if unit in TIMES:
                series.setdefault((sized[1], program, unit), []).append(point)
    for (figure, program, unit), points in series.items():
        if len(points) >= 3:
            costs = "  ".join(f"{size:,}: {number(value)}" for size, value in points)
            yield figure, program, f"{slope(points):.2f}", f"{costs} {unit}"


figures = read(sys.argv[1])
rows = [row for figure, programs in figures.items() for row in rows_of(figure, programs)]
previous = None
for i, row in enumerate(rows):
    rows[i] = ("" if row[0] == previous else row[0], *row[1:])
    previous = row[0]
print()
show(("figure", "program", "median", "ratio", "spread", "peak MB", "also"), rows)
grown = list(growths(figures))
if grown:
    print()
    show(("grows with", "program", "slope", "cost by size"), grown)
