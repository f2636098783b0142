"""A data set prepared once: decoded images, masks and boxes in one file, which every training maps into memory.

A step of the training then copies bytes; it reads no JPEG or PNG, no polygon and no run lengths. The file is made on
first use. It holds a checksum of the annotations, of the images' sizes and times and of what was asked for, and is made
again where that differs. It takes 4 bytes a pixel and one bit a pixel of every object's box.

    bytes       of each image RGB [H, W, 3] and class map [H, W] (0 where nothing is), then its masks' cuts as bits
    index       JSON: checksum; for each image [height, width, offset, objects], for each object
                [label, [x1, y1, x2, y2], [row, column, rows, columns] of the mask's cut, offset]
    8 bytes     length of the index; it stands last, so that a file cut short has none
"""
import hashlib
import json
import os
import pathlib
import sys

import numpy as np

VERSION = 2


def checksum(data, annotations):
    """Of all that decides what the packed file holds."""
    sums = hashlib.sha256(pathlib.Path(annotations).read_bytes())
    facts = [VERSION, data.sides, data.labels, data.least_area]
    for entry, _ in data.entries:
        status = (data.folder / entry["file_name"]).stat()
        facts.append([entry["file_name"], status.st_size, status.st_mtime_ns])
    sums.update(json.dumps(facts).encode())
    return sums.hexdigest()


def cut_out(mask):
    """The smallest window [row, column, rows, columns] with all of a mask, and its pixels as bits."""
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    if not len(rows):
        return [0, 0, 0, 0], b""
    window = [int(rows[0]), int(columns[0]), int(rows[-1] - rows[0]) + 1, int(columns[-1] - columns[0]) + 1]
    cut = mask[window[0]:window[0] + window[2], window[1]:window[1] + window[3]]
    return window, np.packbits(cut != 0).tobytes()


def write(path, data, check):
    """Writes the packed file of `data`, a CocoData; where that is interrupted, nothing is left behind."""
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        with open(part, "wb") as file:
            images = [write_image(file, *data.decode(index)) for index in range(len(data))]
            index = json.dumps(dict(checksum=check, images=images), separators=(",", ":")).encode()
            file.write(index + len(index).to_bytes(8, "little"))
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def write_image(file, pixels, masks, boxes, labels):
    """Writes the bytes of an image; its entry in the index."""
    start, classes = file.tell(), np.zeros(pixels.shape[:2], np.uint8)
    for label, mask in zip(labels, masks):
        classes[mask != 0] = label
    file.write(pixels.tobytes() + classes.tobytes())
    objects = []
    for label, box, mask in zip(labels, boxes.tolist(), masks):
        window, bits = cut_out(mask)
        objects.append([label, box, window, file.tell()])
        file.write(bits)
    return [*classes.shape, start, objects]


def read(path):
    """Index and bytes of a packed file, of one mapping: another training may put a new file in its place meanwhile."""
    content = np.memmap(path, np.uint8, "r")
    end = len(content) - 8
    length = int.from_bytes(content[end:].tobytes(), "little")
    return json.loads(content[end - length:end].tobytes()), content


class PackedData:
    """The packed file of a CocoData, made first where there is none that fits."""

    def __init__(self, data, annotations, path):
        check = checksum(data, annotations)
        try:
            index, self.bytes = read(path)
            fits = index["checksum"] == check
        except (OSError, ValueError, KeyError, TypeError):
            fits = False
        if not fits:
            print(f"decoding {len(data)} images once, to {path}", file=sys.stderr)
            write(path, data, check)
            index, self.bytes = read(path)
        self.images = index["images"]

    def __len__(self):
        return len(self.images)

    def size(self, index):
        return self.images[index][:2]

    def objects(self, index):
        """Labels and boxes of an image."""
        objects = self.images[index][3]
        return [o[0] for o in objects], np.array([o[1] for o in objects], np.float32).reshape(-1, 4)

    def pixels(self, index):
        """RGB [H, W, 3] and class map [H, W]; views of the file."""
        height, width, offset, _ = self.images[index]
        middle, end = offset + 3 * height * width, offset + 4 * height * width
        return self.bytes[offset:middle].reshape(height, width, 3), self.bytes[middle:end].reshape(height, width)

    def masks_into(self, index, out, flip=False):
        """Writes the masks of an image into zeros `out` [objects, H', W'], H' and W' at least the image's; optionally
        mirrored."""
        width = self.images[index][1]
        for mask, (_, _, (row, column, rows, columns), offset) in zip(out, self.images[index][3]):
            size = rows * columns
            cut = np.unpackbits(self.bytes[offset:offset + (size + 7) // 8], count=size).reshape(rows, columns)
            if flip:
                cut, column = cut[:, ::-1], width - column - columns
            mask[row:row + rows, column:column + columns] = cut
