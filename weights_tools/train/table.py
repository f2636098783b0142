#!/usr/bin/python3
"""Tables of several trainings: mean and spread (sample standard deviation) of their COCO numbers, in per cent.

  table.py baseline=out/baseline_1,out/baseline_2 attention=out/attention_1,out/attention_2
  table.py --paired baseline=out/baseline_1,out/baseline_2 attention=out/attention_1,out/attention_2

With --paired also the differences to the first kind, run by run (same seed, same place in the list): their mean and the
half width of its 95 % confidence interval, t s / sqrt(n) of Student's t with n - 1 degrees of freedom; an asterisk where
that excludes 0.

  table.py --file ap_people.json yolov5n=out/yolov5n_1 afnet=out/afnet_1
"""
import json
import math
import pathlib
import statistics
import sys

from evaluate import NAMES


# Student's t of 95 % (two-sided) for 1, 2, ... degrees of freedom.
T_95 = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)


def cell(values):
    values = [100 * v for v in values if v is not None]
    if not values:
        return "-"
    mean = f"{statistics.mean(values):.1f}"
    return f"{mean} ± {statistics.stdev(values):.1f}" if len(values) > 1 else mean


def difference(values, first):
    """Mean of values minus first, pair by pair, in per cent, with its confidence interval."""
    pairs = [100 * (v - f) for v, f in zip(values, first) if v is not None and f is not None]
    if len(pairs) < 2:
        return f"{pairs[0]:+.1f}" if pairs else "-"
    mean, half = statistics.mean(pairs), T_95[len(pairs) - 2] * statistics.stdev(pairs) / math.sqrt(len(pairs))
    return f"{mean:+.1f} ± {half:.1f}" + ("*" if abs(mean) > half else "")


def cells(columns, paired):
    """A row for every kind of network, of whose columns each has a value for every run; then the differences."""
    for name, values in columns.items():
        yield [name, *map(cell, values)]
    if paired:
        first, *others = columns
        for name in others:
            yield [f"{name} - {first}", *map(difference, columns[name], columns[first])]


def rows(runs, kind, paired):
    """COCO's numbers of boxes or masks for every kind of network."""
    yield ["", *NAMES]
    yield from cells({name: [[r[kind][n] for r in reports] for n in NAMES] for name, reports in runs.items()}, paired)


def occlusion_rows(runs, kind, paired):
    """AP for every range of the hidden share."""
    ranges = next(iter(runs.values()))[0].get("occlusion", [])
    yield ["", *(f"{100 * r['from']:.0f}-{100 * r['to']:.0f} % hidden ({r['objects']})" for r in ranges)]
    yield from cells({name: [[report["occlusion"][k][kind]["AP"] for report in reports] for k in range(len(ranges))]
                      for name, reports in runs.items()}, paired)


def markdown(table):
    lines = ["| " + " | ".join(row) + " |" for row in table]
    return "\n".join([lines[0], "|" + " --- |" * lines[0].count(" | ") + " --- |", *lines[1:]])


def main():
    arguments, file = sys.argv[1:], "ap.json"
    paired = arguments[:1] == ["--paired"]
    arguments = arguments[paired:]
    if arguments[:1] == ["--file"] and len(arguments) > 1:
        file, arguments = arguments[1], arguments[2:]
    if not arguments or not all("=" in a for a in arguments):
        raise SystemExit(__doc__)
    runs = {}
    for argument in arguments:
        name, folders = argument.split("=", 1)
        runs[name] = [json.loads((pathlib.Path(f) / file).read_text()) for f in folders.split(",")]
    if paired and (len({len(reports) for reports in runs.values()}) > 1 or len(next(iter(runs.values()))) > len(T_95) + 1):
        raise SystemExit(f"--paired: as many runs of every kind, {len(T_95) + 1} at most; found "
                         + ", ".join(f"{len(reports)} of {name}" for name, reports in runs.items()))
    for kind, title in (("bbox", "Boxes"), ("segm", "Masks")):
        if kind not in next(iter(runs.values()))[0]:
            continue
        print(f"{title}\n\n{markdown(list(rows(runs, kind, paired)))}\n")
        if "occlusion" in next(iter(runs.values()))[0]:
            print(f"{title}, AP by hidden share (objects)\n\n{markdown(list(occlusion_rows(runs, kind, paired)))}\n")


if __name__ == "__main__":
    main()
