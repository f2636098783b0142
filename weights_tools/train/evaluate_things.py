#!/usr/bin/python3
"""Which of the things in rendered images become landmarks, and which landmarks are no things.

  build/penumbra brain landmarks out/judge/drive_0900/rgb --no-pictures --out out/found_900
  evaluate_things.py out/judge/drive_0900=out/found_900 ...          a folder of make_landmarks.py, what was found in its images

  recall     share of the standing things of a class, seen on at least --least pixels, that a landmark of the class shows by
             half: its box has half of the thing's pixels, or the thing fills half of its box
  precision  share of the landmarks of a class that show a thing of it by a quarter
  on movers  share of the landmarks whose boxes persons and vehicles fill by half
"""
import argparse
import collections
import json
import pathlib

import cv2
import numpy as np

MOVING = ("person", "vehicle")


def measure(drive, found, least, count):
    things = json.loads((drive / "landmarks.json").read_text())
    names = {int(number): thing["class"] for number, thing in things.items()}
    moves = {int(number) for number, thing in things.items() if thing["moves"] or thing["class"] in MOVING}
    for image in json.loads((found / "landmarks.json").read_text())["images"]:
        numbers = cv2.imread(str(drive / "landmarks" / pathlib.Path(image["path"]).name), cv2.IMREAD_UNCHANGED)
        sizes = dict(zip(*map(np.ndarray.tolist, np.unique(numbers, return_counts=True))))
        seen = {n for n, size in sizes.items() if n and size >= least and n not in moves and names[n] != "nothing"}
        shown = set()
        for landmark in image["landmarks"]:
            x0, y0, x1, y1 = (int(round(v)) for v in landmark["box"])
            inside, pixels = np.unique(numbers[y0:y1, x0:x1], return_counts=True)
            area = max(1, (x1 - x0) * (y1 - y0))
            shares = {n: max(p / sizes[n], p / area) for n, p in zip(inside.tolist(), pixels.tolist())
                      if n and names[n] == landmark["class"] and n not in moves}
            shown |= {n for n, share in shares.items() if share >= 0.5}
            right = any(share >= 0.25 for share in shares.values())
            on_movers = sum(p for n, p in zip(inside.tolist(), pixels.tolist()) if n in moves) >= 0.5 * area
            count[landmark["class"]] += np.array([0, 0, 1, right, on_movers])
        for n in seen:
            count[names[n]] += np.array([1, n in shown, 0, 0, 0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pairs", nargs="+", metavar="DRIVE=FOUND")
    parser.add_argument("--least", type=int, default=200, help="pixels of a thing")
    options = parser.parse_args()
    count = collections.defaultdict(lambda: np.zeros(5, int))
    for pair in options.pairs:
        drive, found = pair.split("=")
        measure(pathlib.Path(drive), pathlib.Path(found), options.least, count)
    count["all"] = sum(count.values())
    print("| class | things | recall | landmarks | precision | on movers |\n|---|---|---|---|---|---|")
    share = lambda part, whole: f"{100 * part / whole:.1f} %" if whole else "-"
    for name, (seen, shown, landmarks, right, movers) in count.items():
        print(f"| {name} | {seen} | {share(shown, seen)} | {landmarks} | {share(right, landmarks)} | {share(movers, landmarks)} |")


if __name__ == "__main__":
    main()
