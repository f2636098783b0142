"""Compares the detections of two runs of `penumbra segment --json`.

    same_detections.py EXPECTED FOUND PIXELS SCORE

Each instance of one must be in the other, of the same class, with a box within PIXELS and a score within SCORE.
"""
import json
import sys


def shown(path):
    with open(path) as file:
        return [instance for image in json.load(file)["images"] for instance in image["shown"]]


def main(expected_path, found_path, pixels, score):
    expected, found = shown(expected_path), shown(found_path)
    if not expected or len(expected) != len(found):
        sys.exit(f"{found_path}: expected {len(expected)} instances, found {len(found)}")
    worst_box = worst_score = 0.0
    for instance in expected:
        def distance(other):
            return max(abs(a - b) for a, b in zip(instance["box"], other["box"]))
        nearest = min((other for other in found if other["class"] == instance["class"]), key=distance, default=None)
        if nearest is None:
            sys.exit(f"{found_path}: no {instance['class']}")
        found.remove(nearest)
        worst_box = max(worst_box, distance(nearest))
        worst_score = max(worst_score, abs(instance["score"] - nearest["score"]))
    print(f"{found_path}: {len(expected)} instances, boxes within {worst_box:.2g} pixels, scores within {worst_score:.2g}")
    if worst_box > pixels or worst_score > score:
        sys.exit(f"{found_path}: expected boxes within {pixels} pixels and scores within {score}")


main(sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4]))
