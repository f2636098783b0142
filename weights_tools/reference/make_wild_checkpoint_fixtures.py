#!/usr/bin/env python3
"""Write tests/fixtures/checkpoints/wild_*.pth: checkpoints as training scripts leave them.

usage: make_wild_checkpoint_fixtures.py [OUT]        needs PyTorch 2.x and numpy

Each holds the same small network, in another wrapping or beside other values; wild_attack_* would run code in Python.
tests/weights_tools/wild_checkpoint_test.cpp says what is read of each.
"""
import argparse
import collections
import datetime
import enum
import os
import pathlib
import random
import sys
import types

import numpy
import torch


class Colour(enum.Enum):
    RED = 1


class Record:
    """A class that only the training script knows."""

    def __init__(self, **attributes):
        self.__dict__.update(attributes)


class Call:
    """Pickled as a call of a function."""

    def __init__(self, function, *arguments):
        self.call = (function, arguments)

    def __reduce__(self):
        return self.call


def network():
    net = torch.nn.Sequential(torch.nn.Conv2d(1, 2, 1), torch.nn.BatchNorm2d(2), torch.nn.SiLU())
    with torch.no_grad():
        for i, tensor in enumerate(net.state_dict().values()):
            tensor.copy_(torch.arange(tensor.numel()).reshape(tensor.shape) + i)
    return net


def inert_values(net):
    optimiser = torch.optim.SGD(net.parameters(), lr=0.1)
    return {
        "numbers": (numpy.float64(0.5), numpy.int64(2), numpy.bool_(True), 1 + 2j, 1 << 100),
        "arrays": [numpy.arange(6.0).reshape(2, 3), numpy.dtype("f4"), numpy.array([1, "a"], dtype=object)],
        "times": (datetime.datetime(2020, 1, 2), datetime.timedelta(1), datetime.date(2020, 1, 2)),
        "paths": (pathlib.PurePosixPath("a/b"), pathlib.PureWindowsPath("a")),
        "bytes": (b"abc", bytearray(b"abc")),
        "options": argparse.Namespace(lr=0.1, out=pathlib.PurePosixPath("out")),
        "namespace": types.SimpleNamespace(a=1),
        "sets": ({1, 2}, frozenset([3])),
        "others": (slice(1, 2), range(3), Ellipsis, int, Colour.RED, Record(a=1, b=[2])),
        "containers": (collections.defaultdict(list, a=[1]), collections.Counter("aab"), collections.deque([1])),
        "torch": (torch.device("cpu"), torch.Size([1, 2]), torch.float16, torch.strided),
        "random": (random.getstate(), numpy.random.get_state(), torch.zeros(3, dtype=torch.uint8)),
        "scheduler": torch.optim.lr_scheduler.OneCycleLR(optimiser, 0.1, total_steps=5).state_dict(),
        "scheduler_object": Call(getattr, torch.optim.lr_scheduler.OneCycleLR, "_annealing_cos"),
        "optimizer": optimiser.state_dict(),
        "error": ValueError("nan"),
    }


def main():
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else
                       pathlib.Path(__file__).parents[2] / "tests" / "fixtures" / "checkpoints")
    # The classes of this script as a training script's own would be named.
    for own in (Colour, Record):
        own.__module__ = "train"
    sys.modules["train"] = sys.modules["__main__"]
    net = network()
    state = net.state_dict()
    plain = collections.OrderedDict(state.items())

    def save(name, value, **options):
        torch.save(value, out / f"wild_{name}.pth", **options)

    for protocol in (2, 4, 5):
        save(f"inert_{protocol}", {"model": plain, **inert_values(net)}, pickle_protocol=protocol)
        save(f"whole_{protocol}", net, pickle_protocol=protocol)
    save("inert_legacy", {"model": plain, **inert_values(net)}, _use_new_zipfile_serialization=False)
    save("whole_legacy", net, _use_new_zipfile_serialization=False)
    save("whole_parallel", torch.nn.DataParallel(net))
    save("whole_compiled", torch.compile(net))
    net.names, net.stride = {0: "cat", 1: "dog, small"}, torch.tensor([8.0, 16.0, 32.0])
    save("whole_named", {"epoch": 3, "model": net, "ema": None})
    for name, prefix in (("lightning", "model."), ("twice", "module.module."), ("compiled", "_orig_mod."),
                         ("mixed", "model._orig_mod.module.")):
        save(f"prefix_{name}", {prefix + key: tensor for key, tensor in plain.items()})
    averaged = {"module." + key: tensor for key, tensor in plain.items()}
    save("averaged", {"n_averaged": torch.tensor(7), **averaged})
    for key in ("net", "model_ema", "params", "generator", "my_network"):
        save(f"key_{key}", {"epoch": 1, key: plain, "optimizer": inert_values(net)["optimizer"], "loss": torch.ones(1)})
    save("two", {"model": plain, "ema": {key: tensor * 0 for key, tensor in plain.items()}})
    save("two_partial", {"model": plain, "ema": {"0.weight": torch.zeros(2, 1, 1, 1)}})
    save("two_equal", {"netA": {key: tensor * 0 for key, tensor in plain.items()}, "netB": plain})
    save("whole_numbers", {0: torch.ones(2), 1: torch.zeros(3)})
    save("complex", {**plain, "freqs": torch.ones(3, dtype=torch.complex64)})
    save("neg", {"weight": torch._neg_view(torch.ones(3))})
    save("conj", {"weight": torch.ones(3, dtype=torch.complex64).conj()})
    save("sparse_beside", {"model": plain, "graph": torch.eye(2).to_sparse()})
    save("none", {"state_dict": {}, "epoch": 1})
    save("attack_system", {"model": plain, "x": Call(os.system, "touch penumbra_was_here")})
    save("attack_eval", Call(eval, "print('penumbra_was_here')"))
    save("attack_getattr", {"model": plain, "x": Call(getattr, torch.nn.Module, "__init__")})


if __name__ == "__main__":
    main()
