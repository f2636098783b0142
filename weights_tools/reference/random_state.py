"""State dicts from the counter-based generator, the same as tests/support/random_network.cpp makes."""
import numpy as np
import torch

from counter_random import counter_uniform, uniform_tensor


def random_state(shapes, gain):
    """Tensors for the names and shapes of `shapes`: stream 1, 2, ... in the order of the sorted names. Norms are
    near the identity; weights are scaled by gain(name) sqrt(3 / fan-in), so that activations keep their size."""
    state = {}
    for stream, name in enumerate(sorted(shapes), start=1):
        shape = tuple(shapes[name])
        value = uniform_tensor(stream, shape)
        norm = "bn" in name or "downsample.1" in name
        if name.endswith("running_var") or norm and name.endswith("weight"):
            value = np.float32(1.0) + np.float32(0.25) * value
        elif len(shape) == 1:
            value = np.float32(0.1) * value
        else:
            value = np.float32(gain(name) * np.sqrt(3.0 / np.prod(shape[1:]))) * value
        state[name] = torch.from_numpy(value)
    return state


def random_image(seed, width, height):
    """Blocks of random colour, 8 x 8 pixels each, and noise; BGR."""
    rows, columns = (height + 7) // 8, (width + 7) // 8
    coarse = counter_uniform(seed, rows * columns * 3).reshape(rows, columns, 3).repeat(8, axis=0).repeat(8, axis=1)
    noise = uniform_tensor(seed + 1000, (height, width, 3))
    value = np.float32(127.5) + np.float32(90.0) * coarse[:height, :width] + np.float32(30.0) * noise
    return value.astype(np.uint8)  # truncated; inside 0..255
