#!/usr/bin/python3
"""How often a place that was seen before is known again by its landmarks.

  build/penumbra brain landmarks out/drive/sequences/00/image_2 --no-pictures --out out/found
  evaluate_landmarks.py --landmarks out/found/landmarks.json --poses out/drive/poses/00.txt

Every frame is compared with all frames that lie `--apart` metres of way before it. Those within `--near` metres and 30
degrees show the same place, those beyond three times as far, or turned by 60 degrees, another.

  rank k               share of the frames of places seen before for which one of the k most similar ones is of the place
  without a wrong one  share that is found by a threshold which no frame's best one reaches where that is of another place
  area                 under the ROC curve: how often a pair of one place is more similar than one of two places
"""
import argparse
import json
import pathlib

import numpy as np


def read_poses(path):
    """KITTI's or TUM's: places and headings, metres and radians."""
    rows = [line.split() for line in open(path) if not line.startswith("#")]
    values = np.array(rows, float)
    if values.shape[1] == 12:
        matrices = values.reshape(-1, 3, 4)
        return matrices[:, [0, 2], 3], np.arctan2(matrices[:, 0, 2], matrices[:, 2, 2])
    x, y, z, w = values[:, 4:8].T
    return values[:, [1, 3]], np.arctan2(2 * (x * z + y * w), 1 - 2 * (x * x + y * y))


class ByLandmarks:
    """similarity() of slam/brain/landmarks/similarity.h."""

    def __init__(self, path, interest, least_cosine):
        images = json.loads(pathlib.Path(path).read_text())["images"]
        names = sorted({landmark["class"] for image in images for landmark in image["landmarks"]})
        self.least_cosine = least_cosine
        self.frames = []
        for image in images:
            found = image["landmarks"]
            self.frames.append((np.array([names.index(l["class"]) for l in found], int),
                                np.array([l["interest"] if interest else 1.0 for l in found]),
                                np.array([l["descriptor"] for l in found]).reshape(len(found), -1)))

    def __len__(self):
        return len(self.frames)

    def __call__(self, k, j):
        (class_a, interest_a, a), (class_b, interest_b, b) = self.frames[k], self.frames[j]
        total = interest_a.sum() + interest_b.sum()
        if not len(a) or not len(b):
            return 0.0
        likeness = (a @ b.T - self.least_cosine) / (1 - self.least_cosine)
        likeness[(class_a[:, None] != class_b) | (likeness <= 0)] = 0
        common = 0.0
        rows, columns = np.nonzero(likeness)
        order = np.argsort(-likeness[rows, columns], kind="stable")
        used_a, used_b = set(), set()
        for i, m in zip(rows[order], columns[order]):
            if i not in used_a and m not in used_b:
                used_a.add(i)
                used_b.add(m)
                common += np.sqrt(interest_a[i] * interest_b[m]) * min(likeness[i, m], 1.0)
        return 2 * common / total


def measure(similarity, places, headings, apart, near):
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    rows, same, other = [], [], []
    for k in range(len(similarity)):
        count = int(np.searchsorted(way, way[k] - apart, side="right")) if way[k] >= apart else 0
        if count == 0:
            continue
        turned = np.abs((headings[:count] - headings[k] + np.pi) % (2 * np.pi) - np.pi)
        distance = np.linalg.norm(places[:count] - places[k], axis=1)
        right = (distance <= near) & (turned <= np.radians(30))
        wrong = (distance > 3 * near) | (turned > np.radians(60))
        scores = np.array([similarity(k, j) for j in range(count)])
        same.extend(scores[right])
        other.extend(scores[wrong])
        order = np.argsort(-scores, kind="stable")[:5]
        rows.append((right.any(), right[order[0]], right[order].any(), wrong[order[0]], scores[order[0]]))
    again, first, fifth, misled, best = map(np.array, zip(*rows))
    threshold = best[misled].max() if misled.any() else 0.0
    ranks = np.concatenate([same, other]).argsort(kind="stable").argsort() + 1
    area = (ranks[:len(same)].mean() - (len(same) + 1) / 2) / max(1, len(other))
    return dict(frames=int(again.sum()), others=int((~again).sum()), rank_1=float(first[again].mean()),
                rank_5=float(fifth[again].mean()), all_right=float((first & (best > threshold))[again].mean()),
                threshold=float(threshold), area=float(area), same=float(np.mean(same)), other=float(np.mean(other)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--landmarks", required=True, help="landmarks.json")
    parser.add_argument("--poses", required=True, help="KITTI's or TUM's, a pose a frame")
    parser.add_argument("--interest", action=argparse.BooleanOptionalAction, default=True)
    parser.add_argument("--least-cosine", type=float, default=0.6)
    parser.add_argument("--apart", type=float, default=30.0)
    parser.add_argument("--near", type=float, default=4.0)
    options = parser.parse_args()
    similarity = ByLandmarks(options.landmarks, options.interest, options.least_cosine)
    places, headings = read_poses(options.poses)
    result = measure(similarity, places, headings, options.apart, options.near)
    print("{frames} frames of places seen before, {others} others: rank 1 {rank_1:.1%}, rank 5 {rank_5:.1%}, "
          "without a wrong one {all_right:.1%} (above {threshold:.3f}); similarity {same:.3f} of the same place, {other:.3f} of "
          "another, area under the curve {area:.4f}".format(**result))


if __name__ == "__main__":
    main()
