#!/usr/bin/python3
"""Writes tests/fixtures/interest: what the PyTorch module of interest.py finds, for the tests of nn/models/interest_network.

usage: make_interest_fixtures.py

  random.json   raw outputs of small networks with weights from counter_random, with and without attention, folded or not
  street.json   what weights_tools/models/penumbra-interest finds in street.jpg; to be written again whenever it changes

street.jpg is a frame of a street that it was not trained on: `penumbra synth --seed 950 --colour --frames 9`, frame 8, left.
Needs PyTorch and OpenCV.
"""
import json
import pathlib
import sys

import cv2
import numpy as np
import torch
from torch.nn import functional as F

from interest import STRIDE, InterestNetwork, of_state
from random_state import random_image, random_state

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "weights_tools" / "train"))
import safetensors_file  # noqa: E402

MODEL = "weights_tools/models/penumbra-interest.safetensors"
GREY = 114


def gain(name):
    """Keeps activations at about their size, and attention from looking at one pixel alone."""
    return 0.7 if name in ("encoder.2", "encoder.4", "encoder.5", "coarse.1") or "attention" in name else 1.4


def sampled(tensor, step):
    flat = tensor.flatten().numpy()
    return {i: round(float(flat[i]), 5) for i in range(0, len(flat), step)}


def random_case(seed, channels, classes, embedding, attention, folded, size):
    network = InterestNetwork(channels, classes, embedding, attention, folded).eval()
    shapes = {k: v.shape for k, v in network.state_dict().items() if not k.endswith("num_batches_tracked")}
    state = random_state(shapes, lambda name: gain(name.removesuffix(".conv.weight")))
    if attention:
        state["attention.gamma"] = torch.tensor([0.8])
    network.load_state_dict(state, strict=False)
    image = random_image(seed, *size)[:, :, ::-1].copy()
    with torch.no_grad():
        logits, vectors = network(torch.from_numpy(image).permute(2, 0, 1)[None].float() / 255)
    print("random", seed, tuple(logits.shape), "logits", float(logits.std()), "embedding", float(vectors.std()))
    return dict(seed=seed, channels=channels, classes=classes, embedding=embedding, attention=attention, folded=folded, size=size,
                logits=sampled(logits, 7), vectors=sampled(vectors, 13))


def framed(image):
    """In the middle of a grey frame up to multiples of the stride; where the image begins."""
    height, width = image.shape[:2]
    left, top = (round((-extent % STRIDE) / 2 - 0.1) for extent in (width, height))
    out = np.full((height + -height % STRIDE, width + -width % STRIDE, 3), GREY, np.uint8)
    out[top:top + height, left:left + width] = image
    return out, left, top


def street_case(folder):
    image = cv2.imread(str(folder / "street.jpg"))
    boxed, left, top = framed(image)
    network = of_state(safetensors_file.load(ROOT / MODEL)[0])
    with torch.no_grad():
        logits, vectors = network(torch.from_numpy(boxed[:, :, ::-1].copy()).permute(2, 0, 1)[None].float() / 255)
    rows = slice(top // 8, (top + image.shape[0] + 7) // 8)
    columns = slice(left // 8, (left + image.shape[1] + 7) // 8)
    probabilities = torch.softmax(logits, 1)[0, :, rows, columns].permute(1, 2, 0)
    vectors = F.normalize(vectors, dim=1)[0, :, rows, columns].permute(1, 2, 0)
    return dict(weights=MODEL, image="street.jpg", height=probabilities.shape[0], width=probabilities.shape[1],
                probabilities=sampled(probabilities, 61), embeddings=sampled(vectors, 97))


def main():
    folder = ROOT / "tests" / "fixtures" / "interest"
    folder.mkdir(parents=True, exist_ok=True)
    cases = [random_case(1, (16, 32, 64, 96), 11, 32, True, False, (64, 48)),
             random_case(2, (8, 16, 24, 40), 5, 16, True, True, (48, 80)),
             random_case(3, (16, 16, 32, 32), 11, 20, False, False, (32, 32))]
    (folder / "random.json").write_text(json.dumps(cases, separators=(",", ":")) + "\n")
    if (ROOT / MODEL).exists():
        (folder / "street.json").write_text(json.dumps(street_case(folder), separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
