#!/usr/bin/python3
"""Writes tests/fixtures/mask_rcnn/tiny.json: what PyTorch finds with weights_tools/models/penumbra-tiny.safetensors in
tests/fixtures/mask_rcnn/street.png, for the tests of nn/models/mask_rcnn. To be run again whenever the weights change.

usage: make_tiny_fixtures.py

street.png is a frame of `penumbra synth --seed 901 --preset crowded --colour --frames 40`, a street that the weights
were not trained on. Needs Debian's python3-torchvision (0.14.1) and python3-opencv.
"""
import pathlib
import sys

import cv2

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "weights_tools" / "train"))
import safetensors_file  # noqa: E402
from config import CONFIGS  # noqa: E402
from make_mask_rcnn_fixtures import detections, write  # noqa: E402
from model import build  # noqa: E402

LEAST_SCORE = 0.1


def main():
    state, metadata = safetensors_file.load(ROOT / "weights_tools" / "models" / "penumbra-tiny.safetensors")
    config = CONFIGS["tiny"]
    model = build(config, attention=any(".attention." in name for name in state), gain=1.0)
    missing, superfluous = model.load_state_dict(state, strict=False)
    assert not superfluous and all(name.endswith("num_batches_tracked") for name in missing), (missing, superfluous)
    folder = ROOT / "tests" / "fixtures" / "mask_rcnn"
    image = cv2.imread(str(folder / "street.png"))
    found = detections(model.eval(), image, LEAST_SCORE)
    print(len(found["scores"]), "detections with at least", LEAST_SCORE)
    write(str(folder / "tiny.json"), [dict(image="street.png", **found)])


if __name__ == "__main__":
    main()
