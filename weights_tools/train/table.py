#!/usr/bin/python3
"""Tables of several trainings: mean and spread (sample standard deviation) of their COCO numbers, in per cent.

  table.py baseline=out/baseline_1,out/baseline_2 attention=out/attention_1,out/attention_2
  table.py --file ap_people.json yolov5n=out/yolov5n_1 afnet=out/afnet_1
"""
import json
import pathlib
import statistics
import sys

from evaluate import NAMES


def cell(values):
    values = [100 * v for v in values if v is not None]
    if not values:
        return "-"
    mean = f"{statistics.mean(values):.1f}"
    return f"{mean} ± {statistics.stdev(values):.1f}" if len(values) > 1 else mean


def rows(runs, kind):
    """COCO's numbers of boxes or masks for every kind of network."""
    yield ["", *NAMES]
    for name, reports in runs.items():
        yield [name, *(cell([r[kind][n] for r in reports]) for n in NAMES)]


def occlusion_rows(runs, kind):
    """AP for every range of the hidden share."""
    ranges = next(iter(runs.values()))[0].get("occlusion", [])
    yield ["", *(f"{100 * r['from']:.0f}-{100 * r['to']:.0f} % hidden ({r['objects']})" for r in ranges)]
    for name, reports in runs.items():
        yield [name, *(cell([report["occlusion"][k][kind]["AP"] for report in reports]) for k in range(len(ranges)))]


def markdown(table):
    lines = ["| " + " | ".join(row) + " |" for row in table]
    return "\n".join([lines[0], "|" + " --- |" * lines[0].count(" | ") + " --- |", *lines[1:]])


def main():
    arguments, file = sys.argv[1:], "ap.json"
    if arguments[:1] == ["--file"] and len(arguments) > 1:
        file, arguments = arguments[1], arguments[2:]
    if not arguments or not all("=" in a for a in arguments):
        raise SystemExit(__doc__)
    runs = {}
    for argument in arguments:
        name, folders = argument.split("=", 1)
        runs[name] = [json.loads((pathlib.Path(f) / file).read_text()) for f in folders.split(",")]
    for kind, title in (("bbox", "Boxes"), ("segm", "Masks")):
        if kind not in next(iter(runs.values()))[0]:
            continue
        print(f"{title}\n\n{markdown(list(rows(runs, kind)))}\n")
        if "occlusion" in next(iter(runs.values()))[0]:
            print(f"{title}, AP by hidden share (objects)\n\n{markdown(list(occlusion_rows(runs, kind)))}\n")


if __name__ == "__main__":
    main()
