"""Reads and writes safetensors: an 8-byte header length, the header as JSON, then the tensors' bytes."""
import json
import pathlib

import torch

DTYPES = {torch.float32: "F32", torch.float16: "F16"}


def load(path):
    """All tensors as f32, and the metadata."""
    data = pathlib.Path(path).read_bytes()
    start = 8 + int.from_bytes(data[:8], "little")
    header = json.loads(data[8:start])
    metadata, state = header.pop("__metadata__", {}), {}
    types = {name: dtype for dtype, name in DTYPES.items()}
    for name, entry in header.items():
        begin, end = (start + offset for offset in entry["data_offsets"])
        tensor = torch.frombuffer(bytearray(data[begin:end]), dtype=types[entry["dtype"]])
        state[name] = tensor.reshape(entry["shape"]).float()
    return state, metadata


def save(path, state, metadata):
    """`metadata` values are texts. Tensors of rank 2 and more become f16; norms and biases stay f32, they are few and
    a running variance may be smaller than f16 tells apart."""
    header, chunks, offset = {"__metadata__": {key: str(value) for key, value in metadata.items()}}, [], 0
    for name in sorted(state):
        if name.endswith("num_batches_tracked"):
            continue
        tensor = state[name].detach().cpu().contiguous()
        tensor = tensor.half() if tensor.dim() > 1 else tensor.float()
        if not torch.isfinite(tensor).all():
            raise ValueError(f"{name}: not finite, or too large for f16")
        data = tensor.numpy().tobytes()
        header[name] = {"dtype": DTYPES[tensor.dtype], "shape": list(tensor.shape),
                        "data_offsets": [offset, offset + len(data)]}
        chunks.append(data)
        offset += len(data)
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)
    with open(path, "wb") as file:
        file.write(len(text).to_bytes(8, "little") + text)
        file.writelines(chunks)
