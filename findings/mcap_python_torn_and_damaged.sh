#!/bin/bash
# MCAP recordings whose recorder was killed, and one with a flipped byte, through the Python library mcap. Of the torn file
# make_reader gives no message but an error about a record of an absurd length; NonSeekingReader, which "reads
# sequentially", gives none either (it sorts all messages by time first); only StreamReader hands out the whole chunks
# that are there. The damaged chunk is read by all of them without a word: its CRC-32 is not looked at unless
# validate_crcs=True.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q mcap==1.6.0
cat > a.py <<'P'
import io
from mcap.reader import NonSeekingReader, make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

def recording(finished):
    file = io.BytesIO()
    writer = Writer(file, chunk_size=200, compression=CompressionType.NONE)
    writer.start("", "demo")
    channel = writer.register_channel("/left", "json", writer.register_schema("a", "jsonschema", b"{}"))
    for i in range(10):
        writer.add_message(channel, i, b"%d" % i + b"x" * 80, i)
    if finished:
        writer.finish()
    return file.getvalue()

def read(messages):
    got = []
    try:
        for m in messages():
            got.append(m)
        return len(got), "no error"
    except Exception as error:
        return len(got), type(error).__name__

def streamed(data):
    return read(lambda: (r for r in StreamReader(io.BytesIO(data)).records if isinstance(r, Message)))

torn, whole = recording(False), recording(True)
damaged = bytearray(whole)
damaged[damaged.find(b"5xxxx") + 3] = ord("Y")
damaged = bytes(damaged)
seen = {
    "torn, make_reader": read(lambda: make_reader(io.BytesIO(torn)).iter_messages()),
    "torn, NonSeekingReader": read(lambda: NonSeekingReader(io.BytesIO(torn)).iter_messages()),
    "torn, StreamReader": streamed(torn),
    "damaged, make_reader": read(lambda: make_reader(io.BytesIO(damaged)).iter_messages()),
    "damaged, make_reader(validate_crcs=True)": read(lambda: make_reader(io.BytesIO(damaged), validate_crcs=True).iter_messages()),
}
import importlib.metadata
print("mcap", importlib.metadata.version("mcap"))
for name, (count, error) in seen.items():
    print(f"{name}: {count} of 10 messages, {error}")
assert seen["torn, make_reader"][0] == 0 and seen["torn, NonSeekingReader"][0] == 0
assert seen["torn, StreamReader"][0] > 0 and seen["damaged, make_reader"] == (10, "no error")
assert seen["damaged, make_reader(validate_crcs=True)"][1] != "no error"
P
v/bin/python a.py
