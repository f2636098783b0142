#!/usr/bin/python3
"""Writes tests/fixtures/afnet: what the PyTorch module of afnet.py finds, for the tests of nn/models/yolov5.

usage: make_afnet_fixtures.py

  random.json   raw outputs of small networks with weights from counter_random: attention alone, ASFF alone, both
  office.json   what weights_tools/models/penumbra-office and penumbra-afnet find in office.jpg; to be written again
                whenever one of them changes

office.jpg is a frame of an office that neither was trained on or judged by: `penumbra synth --scene office --seed 950 --preset walking-xyz`, frame 8.
Needs Debian's python3-torchvision, python3-opencv and python3-numpy.
"""
import pathlib
import sys

import cv2

from make_yolov5_fixtures import detections, random_case, write

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "weights_tools" / "train"))
import safetensors_file  # noqa: E402
from afnet import of_state  # noqa: E402

MODELS = ("penumbra-office", "penumbra-afnet")


def random_cases():
    for seed, (attention, fusion) in enumerate(((True, False), (False, True), (True, True)), start=1):
        case = random_case(seed, 0.125, 1 / 3, 3, False, seed % 2 == 0, (96, 64), attention, fusion)
        yield dict(case, attention=attention, fusion=fusion)
    # AFNET-n with masks: several blocks of 16 channels at every level.
    yield dict(random_case(4, 0.25, 1 / 3, 2, True, True, (64, 96), True, True), attention=True, fusion=True)


def main():
    folder = ROOT / "tests" / "fixtures" / "afnet"
    folder.mkdir(parents=True, exist_ok=True)
    write(str(folder / "random.json"), list(random_cases()))
    cases = []
    for model in MODELS:
        path = ROOT / "weights_tools" / "models" / f"{model}.safetensors"
        if not path.exists():
            print("no", path)
            continue
        found = detections(of_state(safetensors_file.load(path)[0]), cv2.imread(str(folder / "office.jpg")))
        print(model, len(found["scores"]), "detections")
        cases.append(dict(weights=f"weights_tools/models/{model}.safetensors", image="office.jpg", **found))
    write(str(folder / "office.json"), cases)


if __name__ == "__main__":
    main()
