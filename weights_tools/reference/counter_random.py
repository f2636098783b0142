"""Random numbers from a counter, the same as nn/base/counter_random.h makes."""
import numpy as np


def counter_uniform(seed, count, start=0):
    """Numbers start .. start + count - 1 of stream `seed`: f32, uniform in [-1, 1)."""
    with np.errstate(over="ignore"):
        x = np.arange(start, start + count, dtype=np.uint32) + np.uint32((0x9E3779B9 * seed) & 0xFFFFFFFF)
        x = (x ^ (x >> np.uint32(16))) * np.uint32(0x7FEB352D)
        x = (x ^ (x >> np.uint32(15))) * np.uint32(0x846CA68B)
        x = x ^ (x >> np.uint32(16))
    return (x >> np.uint32(8)).astype(np.float32) * np.float32(2.0**-23) - np.float32(1.0)


def uniform_tensor(seed, shape):
    return counter_uniform(seed, int(np.prod(shape))).reshape(shape)
