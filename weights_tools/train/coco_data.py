"""COCO instances files: reading, and images with their objects."""
import collections
import json
import pathlib

import cv2
import numpy as np


def decode_counts(text):
    """Run lengths from COCO's compressed text: 5 bits a character, each run after the second less the one two before."""
    counts, position = [], 0
    codes = text.encode()
    while position < len(codes):
        value, shift, more = 0, 0, True
        while more:
            code = codes[position] - 48
            value |= (code & 31) << shift
            shift += 5
            more = bool(code & 32)
            position += 1
        if code & 16:
            value -= 1 << shift
        if len(counts) > 2:
            value += counts[-2]
        counts.append(value)
    return counts


def counts_of(mask):
    """Plain run lengths of a mask, column by column, first of zeros."""
    flat = np.concatenate([[0], mask.T.ravel(), [2]])
    return np.diff(np.flatnonzero(np.diff(flat)), prepend=0).tolist()


def decode_mask(segmentation, height, width):
    """A segmentation (compressed or plain run lengths, or polygons) as an array of 0 and 1."""
    if isinstance(segmentation, list):
        mask = np.zeros((height, width), np.uint8)
        for polygon in segmentation:
            corners = np.round(np.reshape(polygon, (-1, 2)) - 0.5).astype(np.int32)
            cv2.fillPoly(mask, [corners], 1)
        return mask
    counts = segmentation["counts"]
    if isinstance(counts, str):
        counts = decode_counts(counts)
    values = (np.arange(len(counts)) & 1).astype(np.uint8)
    flat = np.repeat(values, counts)
    if flat.size != height * width:
        raise ValueError(f"a mask of {flat.size} pixels for an image of {width}x{height}")
    return flat.reshape(width, height).T


LUMA = np.array([[0.299], [0.587], [0.114]], np.float32)  # of red, green, blue: what a grey camera sees


def read_rgb(path):
    """Image [H, W, 3] of bytes."""
    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        raise SystemExit(f"{path}: no image that can be read")
    return np.ascontiguousarray(image[:, :, ::-1])


def labels_of(categories, classes, annotations):
    """Label of the id of every category that is learned, see CocoData; `annotations`: the file, for the error."""
    ids = {c["name"]: c["id"] for c in categories}
    missing = [name for name in classes if name not in ids]
    if missing:
        raise SystemExit(f"{annotations}: no category {', '.join(missing)}; it has {', '.join(ids)}")
    return {ids[name]: k for k, name in enumerate(classes, 1)} if classes else {i: i for i in ids.values()}


class CocoData:
    """A data set: folder of images and its annotations. `classes` names the categories to learn, in the order of the
    network's outputs; empty: a category's id is its label. Objects that show less than `least_area` pixels, crowds and
    objects of images that are not listed are left out. `sides`: the shorter side that images are scaled to and the
    longest they may get then; none: images as they are."""

    def __init__(self, annotations, images, classes=(), least_area=12, sides=None):
        self.folder, self.sides, self.least_area = pathlib.Path(images), sides, least_area
        content = json.loads(pathlib.Path(annotations).read_text())
        label = labels_of(content["categories"], classes, annotations)
        self.labels = sorted(label.items())
        factors = {i["id"]: self.factor(i["height"], i["width"]) for i in content["images"]}
        objects = collections.defaultdict(list)
        for a in content["annotations"]:
            if a.get("iscrowd") or a["category_id"] not in label or min(a["bbox"][2:]) < 1 or a["image_id"] not in factors:
                continue
            if a["area"] * factors[a["image_id"]] ** 2 >= least_area:
                objects[a["image_id"]].append((label[a["category_id"]], a["bbox"], a["segmentation"]))
        self.entries = [(i, objects[i["id"]]) for i in content["images"] if objects[i["id"]]]
        self.instances = sum(len(o) for _, o in self.entries)

    def __len__(self):
        return len(self.entries)

    def factor(self, height, width):
        """What an image's sides are multiplied by; 1 where that changes them by less than a pixel."""
        if not self.sides:
            return 1.0
        factor = min(self.sides[0] / min(height, width), self.sides[1] / max(height, width))
        return factor if abs(factor - 1) * max(height, width) >= 1 else 1.0

    def decode(self, index):
        """Image [H, W, 3] of bytes, RGB, masks [O, H, W], boxes [O, 4] as corners, and labels."""
        entry, objects = self.entries[index]
        image = read_rgb(self.folder / entry["file_name"])
        height, width = image.shape[:2]
        masks = np.stack([decode_mask(s, height, width) for _, _, s in objects])
        boxes = np.array([[x, y, x + w, y + h] for _, (x, y, w, h), _ in objects], np.float32)
        factor = self.factor(height, width)
        if factor != 1.0:
            size = round(width * factor), round(height * factor)
            way = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
            image, masks = cv2.resize(image, size, interpolation=way), np.stack([cv2.resize(m, size, interpolation=way) for m in masks])
            boxes *= np.tile([size[0] / width, size[1] / height], 2).astype(np.float32)
        return image, masks, boxes, [label for label, _, _ in objects]
