#!/usr/bin/python3
"""Write the small checkpoints of tests/fixtures/checkpoints, and what PyTorch reads in them (expected.json).

usage: make_checkpoint_fixtures.py [OUT]        (default: tests/fixtures/checkpoints of this project)
       make_checkpoint_fixtures.py --checksums FILE.pth ...

The second form prints, for real checkpoints, the number of tensors, a CRC-32 over the bytes of all tensors in order
of name, and the CRC-32 of the first, the middle and the last: tests/fixtures/checkpoints/real_checksums.json.

Needs PyTorch 1.13 (Debian's python3-torch). The legacy format's storage keys are addresses, so those files differ from
run to run. Do not load the hostile files with PyTorch.
"""
import argparse
import collections
import io
import json
import os
import pathlib
import pickle
import struct
import sys
import zipfile
import zlib

import numpy
import torch

DTYPES = {torch.float64: "F64", torch.float32: "F32", torch.float16: "F16", torch.bfloat16: "BF16", torch.int64: "I64",
          torch.int32: "I32", torch.int16: "I16", torch.int8: "I8", torch.uint8: "U8", torch.bool: "BOOL"}


def raw(tensor):
    """The tensor's elements in row-major order, as bytes."""
    tensor = tensor.detach().contiguous().reshape(-1)
    if tensor.dtype == torch.bfloat16:  # numpy has no bfloat16
        tensor = tensor.view(torch.int16)
    return tensor.numpy().tobytes()


def describe(tensors):
    return {name: {"dtype": DTYPES[t.dtype], "shape": list(t.shape), "hex": raw(t).hex()} for name, t in tensors.items()}


def every_kind():
    """Every element type, shape and stride that a state dict may have."""
    state = collections.OrderedDict()
    for dtype, name in DTYPES.items():
        values = torch.tensor([0.0, 1.0, -2.0, 3.5, 100.0, 0.1])
        if dtype in (torch.uint8, torch.bool):
            values = values.abs()
        state["dtype." + name] = values.to(dtype).reshape(2, 3)
    base = torch.arange(24, dtype=torch.float32)
    state["shared.all"] = base
    state["shared.offset"] = base[5:11]
    state["shared.every_other"] = base[1::2]
    state["shared.transposed"] = base.reshape(4, 6).t()
    state["shared.permuted"] = base.reshape(2, 3, 4).permute(2, 0, 1)
    state["shared.slice"] = base.reshape(4, 6)[1:3, 2:5]
    state["channels_last"] = torch.arange(48, dtype=torch.float16).reshape(1, 3, 4, 4).contiguous(
        memory_format=torch.channels_last)
    state["expanded"] = torch.tensor([[1.5], [2.5]]).expand(2, 5)
    state["scalar"] = torch.tensor(42)
    state["scalar_of_row"] = torch.arange(5.0)[3]
    state["empty"] = torch.zeros(0, 7)
    state["empty_slice"] = base[24:]
    state["parameter"] = torch.nn.Parameter(torch.tensor([1.0, -1.0]))
    state["named \u00e4\u00f6\u00fc \u6a21\u578b"] = torch.tensor([7], dtype=torch.int32)
    state._metadata = collections.OrderedDict([("", {"version": 1})])
    return state


class Payload:
    """Pickles into a call, as an attacker would."""

    def __init__(self, function, *arguments):
        self.function, self.arguments = function, arguments

    def __reduce__(self):
        return self.function, self.arguments


def rewrite(path, out, change, method=zipfile.ZIP_STORED):
    """Copy a zip file with `change(name without folder, bytes)` -> bytes, or None to leave the entry out."""
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(out, "w", method) as target:
        for entry in source.infolist():
            data = change(entry.filename.split("/", 1)[1], source.read(entry))
            if data is not None:
                target.writestr(zipfile.ZipInfo(entry.filename), data, compress_type=method)


def make_valid(out):
    expected = {}

    def save(name, object, tensors, **options):
        torch.save(object, out / name, **options)
        expected[name] = describe(tensors)

    state = every_kind()
    save("every_kind_zip.pth", state, state)
    save("every_kind_legacy.pth", state, state, _use_new_zipfile_serialization=False)
    save("protocol4.pth", state, state, pickle_protocol=4)

    layer = torch.nn.Sequential(torch.nn.Conv2d(2, 3, 1), torch.nn.BatchNorm2d(3))
    torch.manual_seed(1)
    for parameter in layer.parameters():
        torch.nn.init.uniform_(parameter)
    plain = layer.state_dict()
    optimizer = torch.optim.Adam(layer.parameters())
    layer(torch.ones(1, 2, 2, 2)).sum().backward()
    optimizer.step()
    plain = {name: tensor.clone() for name, tensor in layer.state_dict().items()}
    scheduler = torch.optim.lr_scheduler.MultiStepLR(optimizer, [3, 7])
    args = argparse.Namespace(lr=0.1, dataset="coco", device="cpu")
    training = {"model": plain, "optimizer": optimizer.state_dict(), "lr_scheduler": scheduler.state_dict(), "args": args,
                "epoch": 3, "best": 0.5, "loss": torch.tensor(0.25), "done": None, "tags": {"a", "b"}, "big": 1 << 70}
    save("training.pth", training, plain)
    save("training_legacy.pth", training, plain, _use_new_zipfile_serialization=False)
    parallel = {"module." + name: tensor for name, tensor in plain.items()}
    save("parallel.pth", {"epoch": 1, "state_dict": parallel}, plain)
    save("nested.pth", {"model": {"model_state_dict": plain, "note": "x"}}, plain)
    rewrite(out / "every_kind_zip.pth", out / "deflated.pth", lambda name, data: data, zipfile.ZIP_DEFLATED)
    expected["deflated.pth"] = expected["every_kind_zip.pth"]
    return expected


def make_hostile(out):
    torch.save({"weight": Payload(os.system, "touch penumbra_was_here")}, out / "os_system.pth")
    torch.save({"weight": Payload(os.system, "touch penumbra_was_here")}, out / "os_system_legacy.pth",
               _use_new_zipfile_serialization=False)
    torch.save({"weight": Payload(eval, "1 + 1")}, out / "eval.pth", pickle_protocol=4)
    torch.save({"weight": numpy.zeros(3)}, out / "numpy_array.pth")
    torch.save(torch.nn.Linear(2, 2), out / "module.pth")
    torch.save(torch.nn.Linear(2, 2), out / "module_legacy.pth", _use_new_zipfile_serialization=False)
    torch.save({"weight": torch.eye(2).to_sparse()}, out / "sparse.pth")
    torch.save([torch.zeros(2)], out / "list.pth")
    torch.save({"epoch": 3, "lr": 0.1}, out / "no_tensors.pth")
    (out / "plain_pickle.pth").write_bytes(pickle.dumps({"weight": [1, 2, 3]}, protocol=2))

    good = out / "small_zip.pth"
    torch.save(collections.OrderedDict(weight=torch.arange(6.0).reshape(2, 3), bias=torch.ones(2)), good)
    torch.save(collections.OrderedDict(weight=torch.arange(6.0).reshape(2, 3), bias=torch.ones(2)), out / "small_legacy.pth",
               _use_new_zipfile_serialization=False)
    rewrite(good, out / "storage_missing.pth", lambda name, data: None if name == "data/1" else data)
    rewrite(good, out / "storage_short.pth", lambda name, data: data[:-4] if name == "data/0" else data)
    rewrite(good, out / "big_endian.pth", lambda name, data: data)
    with zipfile.ZipFile(out / "big_endian.pth", "a") as archive:
        archive.writestr("small_zip/byteorder", "big")
    with zipfile.ZipFile(out / "other_zip.pth", "w") as archive:
        archive.writestr("readme.txt", "no checkpoint")
    # offset 0 -> 200: the weight's view leaves its storage. BINPERSID, BININT1 0 -> BININT1 200
    rewrite(good, out / "view_outside.pth", lambda name, data: data.replace(b"QK\x00", b"QK\xc8", 1))

    # A claim of 4 GiB where 17 bytes are packed, in the central directory and in the local header alike.
    rewrite(good, out / "claims_gigabytes.pth", lambda name, data: data, zipfile.ZIP_DEFLATED)
    data = bytearray((out / "claims_gigabytes.pth").read_bytes())
    for signature, field in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        at = data.find(signature, data.find(signature) + 1)  # the second entry: data/0
        data[at + field:at + field + 4] = struct.pack("<I", 0xFFFFFFF0)
    (out / "claims_gigabytes.pth").write_bytes(data)

    # A tensor of 2^40 elements expanded from one. (torch.save writes the one.)
    torch.save({"weight": torch.ones(1).expand(1 << 40)}, out / "expanded_terabyte.pth")

    # The legacy format's raw part: the count of the first storage negative, and a key missing from the list.
    legacy = (out / "small_legacy.pth").read_bytes()
    count = legacy.rfind(struct.pack("<q", 6))
    (out / "legacy_negative_count.pth").write_bytes(legacy[:count] + struct.pack("<q", -6) + legacy[count + 8:])
    stream = io.BytesIO(legacy)
    for _ in range(4):
        skip(stream)
    begin = stream.tell()
    keys = pickle.load(stream)
    (out / "legacy_key_missing.pth").write_bytes(legacy[:begin] + pickle.dumps(keys[:1], protocol=2) + legacy[stream.tell():])


def skip(stream):
    """Pass over one pickle without loading it."""
    import pickletools
    for _ in pickletools.genops(stream):
        pass


def checksums(paths):
    result = {}
    for path in paths:
        state = torch.load(path, map_location="cpu")
        names = sorted(state, key=lambda name: name.encode())
        total = 0
        for name in names:
            total = zlib.crc32(raw(state[name]), total)
        some = {names[i]: zlib.crc32(raw(state[names[i]])) for i in (0, len(names) // 2, len(names) - 1)}
        result[pathlib.Path(path).name] = {"tensors": len(names), "crc32": total, "crc32_of": some}
    json.dump(result, sys.stdout, indent=1)
    print()


def main():
    if sys.argv[1:2] == ["--checksums"]:
        checksums(sys.argv[2:])
        return
    root = pathlib.Path(__file__).resolve().parents[2]
    out = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else root / "tests/fixtures/checkpoints"
    out.mkdir(parents=True, exist_ok=True)
    expected = make_valid(out)
    make_hostile(out)
    (out / "expected.json").write_text(json.dumps(expected, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
