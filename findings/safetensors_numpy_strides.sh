#!/bin/bash
# safetensors 0.8.0, numpy writer: an array that is not stored row by row (a transposed weight, an array in Fortran
# order, every second column) is written without an error, with the right shape and with its values in the wrong
# places: the buffer's bytes are taken as they lie. numpy.ascontiguousarray() first is right; the torch writer
# refuses such tensors.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q safetensors==0.8.0 numpy==2.2.6
cat > a.py <<'P'
import numpy as np, safetensors.numpy as sn
a = np.arange(6, dtype=np.float32).reshape(2, 3)
cases = {"row by row": a, "transposed": a.T, "Fortran order": np.asfortranarray(a), "every second column": a[:, ::2], "transposed, ascontiguousarray": np.ascontiguousarray(a.T)}
right = {}
for name, x in cases.items():
    y = sn.load(sn.save({"x": x}))["x"]
    right[name] = y.shape == x.shape and bool((y == x).all())
    print(f"safetensors 0.8.0, {name}: shape {y.shape}, {'right' if right[name] else 'wrong values'} {y.ravel().tolist()} for {x.ravel().tolist()}")
assert right == {"row by row": True, "transposed": False, "Fortran order": False, "every second column": False, "transposed, ascontiguousarray": True}
P
v/bin/python a.py
