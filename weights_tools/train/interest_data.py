"""Frames of drives and rooms with the numbers of their things, for train_interest.py: what make_landmarks.py writes."""
import functools
import json
import pathlib
import sys

import cv2
import numpy as np
import torch

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "reference"))
from interest import CLASSES, STRIDE  # noqa: E402

CELL = 8             # pixels a side of what the network says one thing about
FIRST_STANDING = 3   # classes before are nothing, persons and vehicles
GREY = 114           # of what lies outside an image, as the engine fills it
IGNORED = -1
# A lamp post is narrower than a cell, a sign hardly wider: they take a cell that they fill by a quarter.
THIN = {"person": 1.5, "sign": 3.0, "lamp": 3.0, "screen": 1.5, "poster": 1.5, "small thing": 2.0}
LUMA = np.array([[0.114], [0.587], [0.299]], np.float32)  # of blue, green, red


class Recording:
    def __init__(self, folder):
        self.images = sorted((folder / "rgb").iterdir())
        self.numbers = [folder / "landmarks" / path.name for path in self.images]
        things = json.loads((folder / "landmarks.json").read_text())
        count = 1 + max(map(int, things), default=0)
        self.class_of = np.zeros(count, np.int64)
        self.stands = np.zeros(count, bool)
        self.weight_of = np.ones(count, np.float32)
        for number, thing in things.items():
            self.class_of[int(number)] = CLASSES.index(thing["class"])
            self.stands[int(number)] = CLASSES.index(thing["class"]) >= FIRST_STANDING and not thing["moves"]
            self.weight_of[int(number)] = THIN.get(thing["class"], 1.0)
        self.seen = [self.things_in(k) for k in range(len(self.images))]

    @functools.lru_cache(maxsize=100000)
    def read(self, k):
        image, numbers = cv2.imread(str(self.images[k])), cv2.imread(str(self.numbers[k]), cv2.IMREAD_UNCHANGED)
        if image is None or numbers is None:
            raise SystemExit(f"{self.images[k]}, {self.numbers[k]}: no images that can be read")
        return image, numbers

    def things_in(self, k):
        """The standing things with at least four cells."""
        number, pixels = np.unique(self.read(k)[1], return_counts=True)
        return frozenset(number[(pixels >= 4 * CELL * CELL) & self.stands[number]].tolist())

    def companions(self, k, count, random):
        """Frames that show some of the same, of any time."""
        common = np.array([len(self.seen[k] & seen) if j != k else 0 for j, seen in enumerate(self.seen)], float)
        if np.count_nonzero(common) < count:
            return random.integers(len(self.images), size=count)
        return random.choice(len(self.images), size=count, replace=False, p=common / common.sum())


def cells_of(numbers, weight_of):
    """The number that a cell shows, and its share: every second pixel votes with the weight of its class."""
    height, width = numbers.shape[0] // CELL, numbers.shape[1] // CELL
    some = numbers.reshape(height, CELL, width, CELL)[:, ::2, :, ::2].transpose(0, 2, 1, 3).reshape(height * width, -1)
    weight = weight_of[some]
    votes = (some[:, :, None] == some[:, None, :]).sum(2) * weight
    best = votes.argmax(1)
    rows = np.arange(len(some))
    return some[rows, best].reshape(height, width), (votes[rows, best] / weight.sum(1)).reshape(height, width)


def padded(extent):
    return (extent + STRIDE - 1) // STRIDE * STRIDE


def view(image, numbers, random, mirrored, channels):
    """One frame as another camera, another light and another exposure might show it; half of them grey."""
    height, width = image.shape[:2]
    size = padded(width), padded(height)
    zoom = np.exp(random.uniform(-0.15, 0.25)) * np.exp(random.uniform(-0.05, 0.05, 2))
    shift = (np.array(size) - zoom * (width, height)) * random.uniform(0.2, 0.8, 2)
    matrix = np.array([[zoom[0], 0, shift[0]], [0, zoom[1], shift[1]]])
    window = cv2.warpAffine(image, matrix, size, flags=cv2.INTER_LINEAR, borderValue=(GREY,) * 3)
    numbers = cv2.warpAffine(numbers, matrix, size, flags=cv2.INTER_NEAREST)
    if mirrored:
        window, numbers = window[:, ::-1], numbers[:, ::-1]
    window = window[:, :, channels]
    if random.random() < 0.25:
        window = cv2.blur(window, (1, int(random.integers(2, 5)))[::random.choice([-1, 1])])
    pixels = window.astype(np.float32) / 255
    if random.random() < 0.5:
        pixels = np.repeat(pixels @ LUMA, 3, 2)
    else:
        pixels = pixels * random.uniform(0.85, 1.15, 3).astype(np.float32)
    pixels = np.clip(pixels * random.uniform(0.6, 1.4) + random.uniform(-0.08, 0.08), 0, 1) ** random.uniform(0.8, 1.25)
    pixels = pixels + random.normal(0, 0.012, pixels.shape)
    return pixels[:, :, ::-1].astype(np.float32), numbers


class Samples:
    """Batch k, the same after any resume: `groups` recordings of one kind, `frames` frames of each that show some of the
    same. Images [N, 3, H, W]; of each cell its class (IGNORED where it shows several things) and its thing, counted on
    over the recordings (0: none that may be a landmark)."""

    def __init__(self, folder, groups, frames, room_share, seed):
        self.groups, self.frames, self.room_share, self.seed = groups, frames, room_share, seed
        paths = sorted(path.parent for path in pathlib.Path(folder).glob("*/landmarks.json")
                       if not (path.parent / "depth").exists())  # else it is still being made
        self.kinds = {kind: [Recording(path) for path in paths if path.name.startswith(kind)] for kind in ("drive", "room")}
        self.kinds = {kind: recordings for kind, recordings in self.kinds.items() if recordings}
        print(", ".join(f"{len(r)} {k}s of {sum(len(x.images) for x in r)} frames" for k, r in self.kinds.items()), file=sys.stderr)

    def __getitem__(self, k):
        random = np.random.default_rng([self.seed, k])
        kind = "room" if "room" in self.kinds and random.random() < self.room_share else "drive"
        recordings = self.kinds[kind]
        images, classes, things = [], [], []
        for group, index in enumerate(random.choice(len(recordings), size=self.groups, replace=len(recordings) < self.groups)):
            recording, mirrored = recordings[index], random.random() < 0.5
            # Few persons have few clothes: nothing is known by its colour alone, but a thing keeps it.
            channels = random.permutation(3) if random.random() < 0.3 else np.arange(3)
            first = int(random.integers(len(recording.images)))
            for frame in (first, *recording.companions(first, self.frames - 1, random)):
                pixels, numbers = view(*recording.read(int(frame)), random, mirrored, channels)
                number, share = cells_of(numbers, recording.weight_of)
                images.append(pixels.transpose(2, 0, 1))
                classes.append(np.where(share >= 0.5, recording.class_of[number], IGNORED))
                things.append(np.where((share >= 0.6) & recording.stands[number], number.astype(np.int64) + (group + 1) * 65536, 0))
        return tuple(torch.from_numpy(np.stack(part)) for part in (images, classes, things))
