#!/usr/bin/python3
"""Put a sequence in KITTI's layout, with PGM images, into a recording, with one of the real writers.

usage: record_street.py WRITER KIND SEQUENCE OUT
  rosbag none|lz4|bz2          ROS 1 bag, raw images (Debian's python3-rosbag)
  mcap none|lz4|zstd|unchunked MCAP of CDR messages, raw images (PyPI's mcap and rosbags)
  rosbags sqlite3|mcap|ros1    rosbag2's folder, or a ROS 1 bag (PyPI's rosbags)
Exits with 77 where the writer is not installed.
"""
import pathlib
import sys


def read_pgm(path):
    data = path.read_bytes()
    magic, width, height, most = data.split(maxsplit=4)[:4]
    assert magic == b"P5" and most == b"255"
    size = int(width) * int(height)
    return int(width), int(height), data[-size:]


def sequence(folder):
    """The cameras' P, then (nanoseconds, left, right) frame by frame."""
    calibration = dict(line.split(":") for line in (folder / "calib.txt").read_text().splitlines() if ":" in line)
    P = [[float(v) for v in calibration[name].split()] for name in ("P0", "P1")]
    times = [round(float(t) * 1e9) for t in (folder / "times.txt").read_text().split()]
    images = [sorted((folder / name).glob("*.pgm")) for name in ("image_0", "image_1")]
    return P, [(t, read_pgm(a), read_pgm(b)) for t, a, b in zip(times, *images)]


SIDES = ("left", "right")


def with_rosbag(kind, folder, out):
    import genpy
    import rosbag
    from sensor_msgs.msg import CameraInfo, Image
    P, frames = sequence(folder)
    with rosbag.Bag(out, "w", compression=kind) as bag:
        for number, (time, *images) in enumerate(frames):
            stamp = genpy.Time(time // 10**9, time % 10**9)
            for side, p, (width, height, pixels) in zip(SIDES, P, images):
                info = CameraInfo(height=height, width=width, distortion_model="plumb_bob", D=[0.0] * 5,
                                  K=p[:3] + p[4:7] + p[8:11], R=[1, 0, 0, 0, 1, 0, 0, 0, 1], P=p)
                image = Image(height=height, width=width, encoding="mono8", step=width, data=pixels)
                image.header.stamp = info.header.stamp = stamp
                image.header.frame_id = side
                # A recorder is later than its cameras, and its clock may be set back.
                recorded = genpy.Time(5000 - number, 0)
                bag.write(f"/{side}/image_raw", image, recorded)
                bag.write(f"/{side}/camera_info", info, recorded)


def messages(store, folder):
    """(topic, type, nanoseconds, message) of ROS 1's or ROS 2's types."""
    import numpy
    types = store.types
    Time, Header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    Image, CameraInfo = types["sensor_msgs/msg/Image"], types["sensor_msgs/msg/CameraInfo"]
    Roi = types["sensor_msgs/msg/RegionOfInterest"]
    is_ros1 = "seq" in Header.__dataclass_fields__
    P, frames = sequence(folder)
    for time, *images in frames:
        for side, p, (width, height, pixels) in zip(SIDES, P, images):
            header = Header(**({"seq": 1} if is_ros1 else {}), stamp=Time(sec=time // 10**9, nanosec=time % 10**9),
                            frame_id=side)
            image = Image(header=header, height=height, width=width, encoding="mono8", is_bigendian=0, step=width,
                          data=numpy.frombuffer(pixels, dtype=numpy.uint8))
            names = "DKRP" if is_ros1 else "dkrp"
            values = [[0.0] * 5, p[:3] + p[4:7] + p[8:11], [1, 0, 0, 0, 1, 0, 0, 0, 1], p]
            info = CameraInfo(header=header, height=height, width=width, distortion_model="plumb_bob", binning_x=0,
                              binning_y=0, roi=Roi(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
                              **{n: numpy.array(v, dtype=numpy.float64) for n, v in zip(names, values)})
            yield f"/{side}/image_raw", "sensor_msgs/msg/Image", time, image
            yield f"/{side}/camera_info", "sensor_msgs/msg/CameraInfo", time, info


def with_mcap(kind, folder, out):
    from mcap.writer import CompressionType, Writer
    from rosbags.typesys import Stores, get_typestore
    store = get_typestore(Stores.ROS2_HUMBLE)
    packing = {"lz4": CompressionType.LZ4, "zstd": CompressionType.ZSTD}.get(kind, CompressionType.NONE)
    with open(out, "wb") as file:
        writer = Writer(file, compression=packing, use_chunking=kind != "unchunked")
        writer.start("ros2", "")
        channels = {}
        for topic, name, time, message in messages(store, folder):
            if topic not in channels:
                channels[topic] = writer.register_channel(topic, "cdr", writer.register_schema(name, "ros2msg", b""))
            writer.add_message(channels[topic], time, bytes(store.serialize_cdr(message, name)), time)
        writer.finish()


def with_rosbags(kind, folder, out):
    from rosbags.typesys import Stores, get_typestore
    if kind == "ros1":
        from rosbags.rosbag1 import Writer
        store, writer = get_typestore(Stores.ROS1_NOETIC), Writer(out)
        serialize = store.serialize_ros1
    else:
        from rosbags.rosbag2 import StoragePlugin, Writer
        store = get_typestore(Stores.ROS2_HUMBLE)
        writer, serialize = Writer(out, version=8, storage_plugin=StoragePlugin[kind.upper()]), store.serialize_cdr
    with writer:
        connections = {}
        for topic, name, time, message in messages(store, folder):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=store)
            writer.write(connections[topic], time, serialize(message, name))


writer, kind, folder, out = sys.argv[1:]
try:
    {"rosbag": with_rosbag, "mcap": with_mcap, "rosbags": with_rosbags}[writer](kind, pathlib.Path(folder), out)
except ModuleNotFoundError as error:
    print(error)
    sys.exit(77)
