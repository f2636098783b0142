#!/usr/bin/python3
"""Read what `penumbra export --mcap` wrote with PyPI's mcap and mcap-ros2-support, and compare it with the run.

usage: read_export.py FILE.mcap trajectory_tum.txt       exits with 77 where they are not installed
"""
import sys

try:
    from mcap.reader import make_reader
    from mcap.stream_reader import StreamReader
    from mcap_ros2.decoder import DecoderFactory
except ModuleNotFoundError as error:
    print(error)
    sys.exit(77)

poses = [[float(v) for v in line.split()] for line in open(sys.argv[2]) if not line.startswith("#")]
with open(sys.argv[1], "rb") as file:
    records = list(StreamReader(file, validate_crcs=True).records)
    assert records
    file.seek(0)
    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    statistics = reader.get_summary().statistics
    found, offered = {}, {}
    for schema, channel, message, decoded in reader.iter_decoded_messages():
        found.setdefault(channel.topic, []).append(decoded)
        offered[channel.topic] = channel.metadata["offered_qos_profiles"]
assert statistics.message_count == sum(len(messages) for messages in found.values())
assert len(found["/pose"]) == len(found["/tf"]) == len(found["/path"][0].poses) == len(poses)
for (t, x, y, z, qx, qy, qz, qw), message, of_path in zip(poses, found["/pose"], found["/path"][0].poses):
    for pose in (message, of_path):
        assert abs(pose.header.stamp.sec + pose.header.stamp.nanosec * 1e-9 - t) < 1e-6
        p, q = pose.pose.position, pose.pose.orientation
        assert max(abs(a - b) for a, b in zip((p.x, p.y, p.z), (x, y, z))) < 1e-9
        assert abs(abs(q.x * qx + q.y * qy + q.z * qz + q.w * qw) - 1) < 1e-9
cloud = found["/map"][0]
assert [f.name for f in cloud.fields] == ["x", "y", "z", "rgb"] and len(cloud.data) == cloud.width * cloud.point_step
# One message that a player latches, as rosbag2 has it: 1 is transient local, 2 volatile.
for topic, profile in offered.items():
    lasts = topic in ("/tf_static", "/map", "/path", "/plan")
    assert profile.count("durability: %d" % (1 if lasts else 2)) == 1 and profile.startswith("- history: 1\n  depth: ")
    assert not lasts or len(found[topic]) == 1
fixed = found["/tf_static"][0].transforms
assert fixed[0].child_frame_id == "map"
assert found["/overlay"] and all(m.format == "jpeg" and bytes(m.data[:2]) == b"\xff\xd8" for m in found["/overlay"])
for plan in found.get("/plan", []):
    assert len(plan.data) == plan.info.width * plan.info.height and set(plan.data) <= {-1, 0, 100}
    assert fixed[-1].child_frame_id == plan.header.frame_id
