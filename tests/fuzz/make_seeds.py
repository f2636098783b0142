#!/usr/bin/python3
"""Write the hand-made inputs of tests/fuzz/corpus/<target>. Names that begin with "valid" are read, "bad" are refused.

usage: make_seeds.py [OUT]        (default: tests/fuzz/corpus of this project)

Findings of the fuzzer lie beside them under other names and are left alone. Needs Debian's python3-opencv for JPEGs.
"""
import bz2
import io
import json
import pathlib
import pickle
import sqlite3
import struct
import sys
import zipfile
import zlib

import cv2
import numpy

FIXTURES = pathlib.Path(__file__).parents[1] / "fixtures" / "checkpoints"


def pickles():
    for name in ("small_zip", "every_kind_zip", "parallel", "protocol4", "wild_inert_2", "wild_inert_5", "wild_two",
                 "wild_whole_named", "wild_whole_4", "wild_averaged", "wild_whole_numbers"):
        with zipfile.ZipFile(FIXTURES / f"{name}.pth") as archive:
            entry = next(e for e in archive.namelist() if e.endswith("data.pkl"))
            yield f"valid_{name}", archive.read(entry)
    # A network whose parts hold each other: every way to a part counts.
    part, named = b"ctrain\nPart\n)\x81", b"}X\x08\x00\x00\x00_modules}"
    yield "bad_network_in_itself", b"\x80\x02" + part + b"q\x01" + named + b"X\x01\x00\x00\x00ah\x01ssb."
    levels = b"".join(part + named + b"".join(b"K" + bytes([i]) + b"h" + bytes([level]) + b"s" for i in range(9)) +
                      b"sbq" + bytes([level + 1]) for level in range(1, 9))
    yield "bad_networks_that_share", b"\x80\x02" + part + b"q\x01" + levels + b"."
    yield "bad_no_dict", pickle.dumps([1, 2.5, "text", None, True, (1,), 1 << 70], protocol=2)
    yield "bad_list_in_itself", b"\x80\x02]q\x00h\x00a."
    yield "bad_dict_in_itself", b"\x80\x02}q\x00X\x05\x00\x00\x00modelh\x00s."
    yield "bad_mark_below_values", b"\x80\x02((K\x01."
    yield "bad_memo_far_away", b"\x80\x02Nr\x7f\x84\x1e\x00j\x7f\x84\x1e\x00."
    yield "bad_long", b"\x80\x02\x8a\xff."


def stored_zip(entries):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, data in entries.items():
            archive.writestr(zipfile.ZipInfo(name), data)
    return buffer.getvalue()


def zips():
    with zipfile.ZipFile(FIXTURES / "small_zip.pth") as archive:
        folder = next(e for e in archive.namelist() if e.endswith("data.pkl"))[: -len("data.pkl")]
        entries = {e[len(folder):]: archive.read(e) for e in archive.namelist()}
    wanted = {"a/" + name: data for name, data in entries.items() if name == "data.pkl" or name.startswith("data/")}
    good = stored_zip(wanted)
    yield "valid_without_version", good
    yield "valid_with_byteorder", stored_zip({**wanted, "a/byteorder": b"little"})
    yield "bad_byteorder", stored_zip({**wanted, "a/byteorder": b"big"})
    yield "bad_empty_archive", stored_zip({})
    yield "bad_end_missing", good[:-22]
    yield "bad_comment_length", good[:-2] + b"\xff\xff"


def legacy():
    yield "valid_small", (FIXTURES / "small_legacy.pth").read_bytes()
    yield "valid_whole_network", (FIXTURES / "module_legacy.pth").read_bytes()
    yield "valid_inert_values", (FIXTURES / "wild_inert_legacy.pth").read_bytes()
    yield "bad_magic_alone", pickle.dumps(0x1950A86A20F9469CFC6C, protocol=2)
    yield "bad_other_pickle", pickle.dumps({"weight": [1.0]}, protocol=2)
    yield "bad_protocol_alone", b"\x80\x02"


def safetensors(header, data=b"", length=None):
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return struct.pack("<Q", len(text) if length is None else length) + text + data


def tensor(dtype, shape, begin, end):
    return {"dtype": dtype, "shape": shape, "data_offsets": [begin, end]}


def safetensors_files():
    two = {"__metadata__": {"classes": "cat,dog"}, "a": tensor("F32", [2], 0, 8), "b": tensor("BOOL", [], 8, 9)}
    yield "valid_two_tensors", safetensors(two, bytes(9))
    yield "bad_empty", safetensors({})
    yield "valid_metadata_null", safetensors({"__metadata__": None, "a": tensor("U8", [1], 0, 1)}, b"1")
    yield "valid_unused_types", safetensors({"a": tensor("F8_E4M3", [2], 0, 2), "b": tensor("U32", [1], 2, 6),
                                             "c": tensor("F4", [4], 6, 8)}, bytes(8))
    yield "bad_half_a_byte", safetensors({"a": tensor("F4", [3], 0, 2)}, bytes(2))
    yield "valid_no_elements", safetensors({"a": tensor("F16", [0, 3], 0, 0)})
    yield "valid_nan", safetensors({"a": tensor("F64", [1], 0, 8)}, b"\xff" * 8)
    yield "bad_overlap", safetensors({"a": tensor("I8", [4], 0, 4), "b": tensor("I8", [4], 2, 6)}, bytes(6))
    yield "bad_huge_shape", safetensors({"a": tensor("U8", [1 << 62, 4, 0], 0, 0)})
    yield "bad_many_extents", safetensors({"a": tensor("U8", [(1 << 63) - 1] * 90, 0, 0)})
    yield "bad_header_length", safetensors({}, length=1 << 63)
    yield "bad_nesting", safetensors(b'{"a":' + b"[" * 500)
    yield "bad_utf8", safetensors(b'{"\xff\xfe": 1}')
    yield "bad_escape_in_name", safetensors(b'{"\\u001b[2J": {"dtype": "\\u001b", "shape": [], "data_offsets": [0]}}')
    yield "bad_number", safetensors(b'{"a":{"dtype":"F32","shape":[1e400],"data_offsets":[-1,99999999999999999999]}}')


def codes():
    yield "valid_empty", b""
    yield "valid_square", b"52203"
    yield "valid_long_runs", b"PXm1`2^7n0b02N3L4K6J5L"
    yield "bad_run_of_2_pow_32", b"PPPPPP4"
    yield "bad_negative_run", b"0O0O"
    yield "bad_never_ending", b"oooooooooooooooo"
    yield "bad_character", b"52\x1b[2J"
    yield "bad_high_byte", b"52\xff"


def png_chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, depth, colour, rows, before=b"", interlace=0):
    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlace)
    return (b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header) + before + png_chunk(b"IDAT", zlib.compress(rows, 9)) +
            png_chunk(b"IEND", b""))


ROW = bytes(range(1, 7))


def images():
    yield "valid_grey.png", png(6, 2, 8, 0, (b"\0" + ROW) * 2)
    yield "valid_bits.png", png(6, 2, 1, 0, b"\0\xaa" * 2)
    yield "valid_rgba.png", png(2, 1, 8, 6, b"\1" + bytes(8))
    yield "valid_sixteen_bits.png", png(3, 1, 16, 0, b"\2" + ROW)
    yield "valid_interlaced.png", png(2, 2, 8, 0, b"\0\1\0\2\0\3\4", interlace=1)
    palette = png_chunk(b"PLTE", bytes(12)) + png_chunk(b"tRNS", b"\0\xff") + png_chunk(b"tEXt", b"a\0b")
    yield "valid_palette.png", png(4, 1, 2, 3, b"\0\x1b", palette)
    yield "bad_claims_much.png", png(1 << 13, 1 << 13, 8, 2, b"\0")
    yield "bad_no_pixels.png", png(0, 1, 8, 0, b"\0")
    pixels = numpy.arange(24 * 17 * 3, dtype=numpy.uint32).reshape(17, 24, 3).astype(numpy.uint8)
    for name, flags in {"": [], "_progressive": [cv2.IMWRITE_JPEG_PROGRESSIVE, 1],
                        "_restarts": [cv2.IMWRITE_JPEG_RST_INTERVAL, 1]}.items():
        data = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, 20] + flags)[1].tobytes()
        yield f"valid{name}.jpg", data
        frame = data.find(b"\xff\xc0" if not name.endswith("progressive") else b"\xff\xc2")
        # 65535 x 2048 pixels; the rows are those of 24 x 17
        yield f"bad{name}_claims_much.jpg", data[: frame + 5] + b"\x08\x00\xff\xff" + data[frame + 9:]
    exif = b"MM\0*\0\0\0\x08\0\1\x01\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0"
    yield "valid_turned.png", png(6, 2, 8, 0, (b"\0" + ROW) * 2, png_chunk(b"eXIf", exif))
    yield "valid_ten_bits.png", png(3, 1, 16, 0, b"\2" + ROW, png_chunk(b"sBIT", b"\x0a"))
    jpeg = cv2.imencode(".jpg", pixels)[1].tobytes()
    segment = b"Exif\0\0" + exif
    yield "valid_turned.jpg", jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + jpeg[2:]
    grey = cv2.imencode(".jpg", pixels[:, :, 0])[1].tobytes()
    yield "valid_grey.jpg", grey
    yield "bad_torn.jpg", grey[:-40]
    yield "bad_no_scan.jpg", b"\xff\xd8\xff\xd9"


def images_for_the_decoder():
    """Sound as containers, so only the decoder sees what is wrong."""
    yield from images()
    yield "bad_palette_missing.png", png(4, 1, 2, 3, b"\0\x1b")
    yield "valid_grey.pgm", b"P5 6 1 255\n" + ROW
    yield "valid_wide.pgm", b"P5\n# ten bits\n3 1\n1023\n" + b"\1\2\3\4\0\0"
    yield "valid_text.ppm", b"P3 1 1 7 1 2 7\n"
    yield "bad_torn.pgm", b"P5 60 10 255\n" + ROW
    pixels = numpy.arange(5 * 3 * 3, dtype=numpy.uint8).reshape(3, 5, 3)
    yield "valid_colour.bmp", cv2.imencode(".bmp", pixels)[1].tobytes()
    yield "valid_grey.bmp", cv2.imencode(".bmp", pixels[:, :, 0])[1].tobytes()
    yield "bad_torn.bmp", cv2.imencode(".bmp", pixels)[1].tobytes()[:-1]
    yield "bad_other.tif", b"II*\0\x08\0\0\0"
    yield "bad_filter.png", png(6, 1, 8, 0, b"\x09" + ROW)


def number_files():
    yield "valid_records", b"# comment\r\n1 2 3\r\n\n-1e-3\t+2.5E+2 .5\n0 1e-400 3"
    yield "valid_empty", b""
    yield "bad_word", b"1 2 x\n"
    yield "bad_nan", b"nan inf -inf\n"
    yield "bad_overflow", b"1e400 1 1\n"
    yield "bad_escape", b"1 \x1b[2J 3\n"
    yield "bad_zero_byte", b"1 2 \x003\n"
    yield "bad_sign", b"+-1 2 3"


def calibration(P0, P1):
    rows = {"P0": P0, "P1": P1, "P2": P0, "P3": P1}
    return "".join(f"{name}: {' '.join(map(str, row))}\n" for name, row in rows.items()).encode()


def calibrations():
    P0 = [700.0, 0, 600.0, 0, 0, 700.0, 180.0, 0, 0, 0, 1, 0]
    P1 = P0[:3] + [-380.0] + P0[4:]
    yield "valid", calibration(P0, P1)
    yield "bad_swapped", calibration(P1, P0)
    yield "bad_eleven", calibration(P0[:11], P1)
    yield "bad_baseline_overflows", calibration(P0[:3] + [1e308] + P0[4:], P0[:3] + [-1e308] + P0[4:])
    yield "bad_focal_length", calibration([0.0] * 12, [0.0] * 12)
    yield "bad_half", calibration(P0, P1)[:60]


def trajectories():
    yield "valid_kitti", b"1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 1.5 0 1 0 0 -1 0 0 2.5\n"
    yield "valid_tum", b"# t x y z qx qy qz qw\n0.1 1 2 3 0 0 0 1\n0.2 1 2 4 0.5 0.5 0.5 0.5\n"
    yield "bad_reflection", b"-1 0 0 0 0 1 0 0 0 0 1 0\n"
    yield "bad_rotation_overflows", b"1e200 1e200 0 0 1e200 -1e200 0 0 0 0 1 0\n"
    yield "bad_rotation_hides_overflow", b"1 0 1e200 0 0 1 -1e200 0 0 0 1 0\n"
    yield "bad_quaternion", b"0 1 2 3 1e200 0 0 1\n"
    yield "valid_time_goes_back", b"2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"
    yield "bad_columns", b"1 2 3\n"


def class_lists():
    yield "valid_lines", b"background\nperson\r\n traffic light \n"
    yield "valid_commas", b"person,car,bus"
    yield "valid_umlauts", "Stra\u00dfe\nB\u00e4r".encode()
    yield "bad_latin1", b"B\xe4r\ncar"
    yield "bad_escape", b"car\n\x1b[2J"
    yield "bad_zero_byte", b"car\n\0"


def frame_ranges():
    for name, text in {"valid_both": "0:100", "valid_begin": "50:", "valid_end": ":50", "valid_all": ":",
                       "bad_minus": "-1:5", "bad_minus_zero": "-0:5", "bad_empty": "", "bad_order": "5:5",
                       "bad_large": "0:99999999999", "bad_two_colons": "1:2:3", "bad_escape": "\x1b[2J:1"}.items():
        yield name, text.encode()


def coco_annotation_files():
    image = {"id": 1, "width": 8, "height": 6, "file_name": "1.jpg"}
    category = {"id": 1, "name": "car"}
    annotation = {"id": 1, "image_id": 1, "category_id": 1, "bbox": [1, 1, 3, 2], "area": 6, "iscrowd": 0,
                  "segmentation": [[1, 1, 4, 1, 4, 3, 1, 3]]}
    runs = {"size": [6, 8], "counts": [7, 2, 4, 2, 33]}

    def file(images=(image,), categories=(category,), annotations=(annotation,)):
        return json.dumps(dict(images=images, categories=categories, annotations=annotations)).encode()

    yield "valid_polygon", file()
    yield "valid_crowd", file(annotations=[dict(annotation, iscrowd=1, segmentation=runs)])
    yield "valid_text_ids", file(images=[dict(image, id="a")], annotations=[dict(annotation, image_id="a")])
    yield "valid_none", file(annotations=[])
    yield "valid_runs_of_boxes_alone", file(annotations=[dict(annotation, iscrowd=1, segmentation=dict(runs, counts=[7]))])
    yield "valid_image_not_listed", file(annotations=[dict(annotation, image_id=2)])
    yield "bad_twice", file(annotations=[annotation, annotation])
    yield "bad_box", file(annotations=[dict(annotation, bbox=[1, 1, -3, 2])])
    yield "valid_floats", file(images=[dict(image, width=8.0)], annotations=[dict(annotation, id=0.0)])
    yield "valid_two_points", file(annotations=[dict(annotation, segmentation=annotation["segmentation"] + [[1, 1, 3, 2]])])
    yield "valid_no_sizes", file(images=[{"id": 1}])
    yield "valid_width_0", file(images=[dict(image, width=0)])
    yield "bad_half", file()[:200]
    yield "bad_deep", b"[" * 1000


def coco_result_files():
    result = {"image_id": 1, "category_id": 3, "bbox": [1, 1, 3, 2], "score": 0.5,
              "segmentation": {"size": [6, 8], "counts": "72420Q1"}}
    yield "valid_box", json.dumps([{k: v for k, v in result.items() if k != "segmentation"}]).encode()
    yield "valid_none", b"[]"
    yield "valid_counts_of_boxes_alone", json.dumps([result]).encode()
    yield "bad_score", json.dumps([dict(result, score="high")]).encode()
    yield "valid_category_not_listed", json.dumps([dict(result, category_id=2)]).encode()
    yield "bad_nan", json.dumps([dict(result, score=float("nan"))]).encode()
    yield "bad_object", b"{}"


def checksummed_file(magic, version, body):
    return magic + struct.pack("<IIQ", version, zlib.crc32(body), len(body)) + body


def map_files():
    def camera(offset=0.1):
        return struct.pack("<6d2i", 718.0, 718.0, 607.0, 185.0, 0.54, offset, 1241, 376)

    levels = struct.pack("<I2d", 2, 1.0, 1.2)
    pose = struct.pack("<12d", 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)

    def thing(number=4, width=30, stands=1):
        return struct.pack("<iI3s3d4iB", number, 3, b"car", 1.0, 0.5, 9.0, 10, -4, width, 40, stands)

    def keyframe(frame, pose=pose, u=100.0, level=1, submap=0, things=()):
        feature = struct.pack("<ffiff32sff", u, 50.0, level, 0.1, 9.0, bytes(32), 60.0, 9.7)
        return struct.pack("<id", frame, 0.1 * frame) + pose + struct.pack("<iI", submap, 1) + feature + bytes(4) + \
            struct.pack("<I", len(things)) + b"".join(things)

    def patch(level=1, depth=9.7):
        return struct.pack("<id2f", level, depth, 0.1, -0.2) + bytes(225)

    def point(*observations, x=1.0, patch=struct.pack("<i", -1), aligned=1):
        head = struct.pack("<3d2i", x, 0.0, 9.7, 3, 2) + bytes(3) + patch + struct.pack("<I", len(observations))
        return head + b"".join(struct.pack("<IIB", k, f, aligned) for k, f in observations)

    def file(keyframes, points, version=3, levels=levels, camera=camera()):
        body = camera + levels + struct.pack("<I", len(keyframes)) + b"".join(keyframes)
        body += struct.pack("<I", len(points)) + b"".join(points)
        return checksummed_file(b"PENUMAP\n", version, body)

    two = [keyframe(0), keyframe(5)]
    yield "valid_two", file(two, [point((0, 0), (1, 0))])
    yield "valid_patch", file(two, [point((0, 0), (1, 0), patch=patch(), aligned=0)])
    yield "valid_empty", file([], [])
    yield "valid_objects", file([keyframe(0, things=[thing(), thing(5)])], [])
    yield "bad_object", file([keyframe(0, things=[thing(number=-1)])], [])
    yield "bad_region", file([keyframe(0, things=[thing(width=1 << 30)])], [])
    yield "bad_object_mark", file([keyframe(0, things=[thing(stands=2)])], [])
    yield "bad_version", file(two, [], version=1)
    yield "bad_disparity_offset", file(two, [], camera=camera(offset=2000.0))
    yield "bad_submap", file([keyframe(0, submap=-1)], [])
    yield "bad_patch_level", file(two, [point((0, 0), patch=patch(level=2))])
    yield "bad_patch_depth", file(two, [point((0, 0), patch=patch(depth=-1.0))])
    yield "bad_aligned", file(two, [point((0, 0), aligned=2)])
    yield "bad_feature", file(two, [point((0, 0), (1, 1))])
    yield "bad_keyframe", file(two, [point((0, 0), (2, 0))])
    yield "bad_order", file(two, [point((1, 0), (0, 0))])
    yield "bad_feature_twice", file(two, [point((0, 0)), point((0, 0))])
    yield "bad_unseen", file(two, [point()])
    yield "bad_position", file(two, [point((0, 0), x=float("nan"))])
    yield "bad_rotation", file([keyframe(0, pose=bytes(96))], [])
    yield "bad_pixel", file([keyframe(0, u=1e9)], [])
    yield "bad_level", file([keyframe(0, level=2)], [])
    yield "bad_scales", file([], [], levels=struct.pack("<I2d", 2, 1.0, 0.5))
    yield "bad_torn", file(two, [])[:-3]


def camera_files():
    rectified = "fx: 70\nfy: 70\ncx: 40\ncy: 30\nbaseline: 0.12\n"
    lens = "  fx: 70\n  fy: 70\n  cx: 40\n  cy: 30\n  distortion: [-0.3, 0.1, 0.0, 0.0]\n"
    raw = f"rectified: false\nwidth: 80\nheight: 60\nleft:\n{lens}right:\n{lens}"
    motion = "T_right_left: [1, 0, 0, -0.1,\n  0, 1, 0, 0,\n  0, 0, 1, 0]\n"
    euroc = ("%YAML:1.0\nT_BS:\n  cols: 4\n  data: [0, -1, 0, 0.1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
             "resolution: [752, 480]\nintrinsics: [458.6, 457.3, 367.2, 248.4] #fu\ndistortion_model: radial-tangential\n"
             "distortion_coefficients: [-0.28, 0.07, 0.0002, 1.7e-05]\n")
    yield "valid_rectified", (rectified + "colour: true\nrate: 10\n").encode()
    yield "valid_raw", (raw + motion).encode()
    yield "valid_rgbd", (rectified + "sensor: rgbd\ndepth_factor: 5000\n").encode()
    yield "valid_rows", (raw + "T_right_left:\n- [1, 0, 0, -0.1]\n- [0, 1, 0, 0]\n- [0, 0, 1, 0]\n").encode()
    yield "valid_euroc", euroc.encode()
    yield "bad_empty", b""
    yield "bad_zero_focal_length", rectified.replace("70", "0").encode()
    yield "bad_nan", rectified.replace("40", "nan").encode()
    yield "bad_no_motion", raw.encode()
    yield "bad_motion", (raw + motion.replace("[1", "[3")).encode()
    yield "bad_open_list", euroc.replace("0, 1]", "0, 1").encode()
    yield "bad_size", euroc.replace("752", "1e9").encode()
    yield "bad_twice", (rectified + rectified).encode()
    yield "bad_tab", b"left:\n\tfx: 1\n"
    yield "bad_deep", "".join(" " * d + "k:\n" for d in range(50)).encode()
    yield "bad_not_text", bytes(range(256))


def image_lists():
    yield "valid_tum", b"# timestamp filename\n1305031102.175304 rgb/1305031102.175304.png\n1305031102.3 rgb/2.png\n"
    yield "valid_euroc", b"#timestamp [ns],filename\r\n1403715273262142976,1403715273262142976.png\r\n"
    yield "bad_empty", b"# nothing\n"
    yield "bad_out_of_folder", b"1.5 ../../a.png\n"
    yield "bad_absolute", b"1,/a.png\n"
    yield "bad_back", b"2 a.png\n1 b.png\n"
    yield "bad_time", b"nan a.png\n"
    yield "bad_no_name", b"5\n"



def cognitive_map_files():
    def camera(baseline=0.54):
        return struct.pack("<6d2i", 360.0, 360.0, 310.0, 94.0, baseline, 0.0, 620, 188)

    def point(z=9.0):
        return struct.pack("<4Q4f", 1, 2, 3, 4, 0.5, -0.5, z, 0.0)

    def landmark(kind=3, interest=0.5):
        return struct.pack("<4f", 10, 20, 30, 40) + struct.pack("<i2f", kind, 0.9, interest) + struct.pack("<32f", 1, *[0] * 31)

    def node(view, x=0.0, points=(), activity=(0.5, 1.0)):
        head = struct.pack("<i5d", 7, 0.7, x, 0.0, 0.1, 0.8)
        return head + struct.pack(f"<I{len(activity)}f", len(activity), *activity) + \
            struct.pack("<I", len(points)) + b"".join(points) + view

    def seen(*landmarks):
        return struct.pack("<I", len(landmarks)) + b"".join(landmarks)

    def link(a=0, b=1, metres=0.1, recalled=0):
        return struct.pack("<2i5dB", a, b, 1.0, 0.0, 0.1, metres, 0.01, recalled)

    def file(nodes, links, kind=0, version=1, camera=camera(), scene=12.0, tail=b"", yaw=0.0):
        body = camera + struct.pack("<2dId", yaw, 0.1, kind, scene) + struct.pack("<I", len(nodes)) + b"".join(nodes)
        body += struct.pack("<I", len(links)) + b"".join(links) + tail
        return checksummed_file(b"PENUCOG\n", version, body)

    profile = struct.pack("<600f", *[0.01 * i for i in range(600)])
    two = [node(seen(landmark()), points=[point()]), node(seen(), x=1.0)]
    yield "valid_landmarks", file(two, [link(), link(recalled=1)])
    yield "valid_intensity", file([node(profile), node(profile, x=2.0)], [link()], kind=1)
    yield "valid_empty", file([], [])
    yield "bad_version", file(two, [], version=7)
    yield "bad_kind", file(two, [], kind=2)
    yield "bad_camera", file(two, [], camera=camera(baseline=0.0))
    yield "bad_scene", file(two, [], scene=float("inf"))
    yield "bad_pose", file([node(seen(), x=float("nan"))], [])
    yield "bad_activity", file([node(seen(), activity=(float("nan"),))], [])
    yield "bad_point", file([node(seen(), points=[point(z=float("inf"))])], [])
    yield "bad_class", file([node(seen(landmark(kind=1)))], [])
    yield "bad_interest", file([node(seen(landmark(interest=float("nan"))))], [])
    yield "bad_link_end", file(two, [link(b=2)])
    yield "bad_link_itself", file(two, [link(b=0)])
    yield "bad_deviation", file(two, [link(metres=0.0)])
    yield "bad_tail", file(two, [], tail=b"more")
    yield "bad_yaw", file(two, [], yaw=float("nan"))


def plan_files():
    good = ("image: plan.pgm\nmode: trinary\nresolution: 0.05\norigin: [-1.5, 2, 0.0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    for name, old, new in (("valid_own", "", ""), ("valid_by_hand", "plan.pgm", '"a plan.png" # drawn'),
                           ("valid_windows_line_ends", "\n", "\r\n"), ("bad_no_image", "plan.pgm", ""),
                           ("bad_escape_in_name", "plan.pgm", "\x1b[2J.pgm"), ("bad_no_negate", "negate", "negative"),
                           ("bad_resolution", "0.05", "0"), ("bad_small_resolution", "0.05", "1e-9"),
                           ("bad_junk_after_number", "0.05", "0.05abc"), ("bad_nan", "0.65", "nan"),
                           ("bad_far_origin", "-1.5", "1e300"), ("bad_turned", "2, 0.0", "2, 1.5"),
                           ("bad_four_numbers", "0.0]", "0.0, 9]"), ("bad_open_list", "0.0]", "0.0")):
        yield name, good.replace(old, new).encode()


def odometry_files():
    yield "valid_spaces", b"# time v omega\n0.0 1.0 0.1\n0.5 1.0 0.1\n"
    yield "valid_nanoseconds", b"#t,v,w\n1403636579763555584,1,0\n1403636579863555584,1,0\n"
    yield "bad_one_line", b"0 1 0\n"
    yield "bad_back", b"1 1 0\n0 1 0\n"
    yield "bad_nan", b"0 1 0\n1 nan 0\n"
    yield "bad_columns", b"0 1\n1 1\n"


def euroc_ground_truths():
    yield "valid_two", b"#t,x,y,z,w,x,y,z\n1403636580838555648,4.6,-1.7,0.78,1,0,0,0,0.1\n1403636580843555648,4,1,0,0,1,0,0\n"
    yield "bad_empty", b"#t\n"
    yield "valid_quaternion", b"1,0,0,0,2,0,0,0\n"
    yield "bad_columns", b"1,0,0,0,1\n"
    yield "valid_back", b"2,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n"
    yield "bad_nan", b"1,nan,0,0,1,0,0,0\n"


# The messages of ROS 1 and ROS 2 that recordings hold.
class MessageBytes:
    def __init__(self, cdr, big=False):
        self.data, self.cdr, self.order = b"", cdr, ">" if big else "<"

    def put(self, code, *values):
        for value in values:
            size = struct.calcsize(code)
            if self.cdr:
                self.data += bytes(-len(self.data) % size)
            self.data += struct.pack(self.order + code, value)
        return self

    def blob(self, data):
        self.put("I", len(data))
        self.data += data
        return self

    def text(self, text):
        return self.blob(text.encode() + (b"\0" if self.cdr else b""))

    def header(self, seconds):
        if not self.cdr:
            self.put("I", 1)
        return self.put("I", seconds, 5).text("camera")

    def bytes(self):
        return (b"\0\0\0\0" if self.order == ">" else b"\0\1\0\0") + self.data if self.cdr else self.data


def image_message(cdr, seconds=10, encoding="mono8", width=8, height=6, step=None, data=None, big=False):
    size = {"mono8": 1, "16UC1": 2, "32FC1": 4, "rgb8": 3, "bayer_rggb8": 1, "yuv422": 2}.get(encoding, 1)
    step = step or width * size
    message = MessageBytes(cdr, big).header(seconds).put("I", height, width).text(encoding).put("B", 0).put("I", step)
    return message.blob(bytes(range(256))[:step * height] if data is None else data).bytes()


def camera_message(cdr, focal=70.0, model="plumb_bob", D=(), Tx=0.0, zeros=False, width=8, height=6):
    message = MessageBytes(cdr).header(10).put("I", height, width).text(model).put("I", len(D)).put("d", *D)
    message.put("d", focal, 0.0, 4.0, 0.0, focal, 3.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    P = [focal, 0.0, 4.0, Tx, 0.0, focal, 3.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    return message.put("d", *([0.0] * 12 if zeros else P)).put("I", 0, 0, 0, 0, 0, 0).put("B", 0).bytes()


def packed_message(cdr, form, data):
    return MessageBytes(cdr).header(10).text(form).blob(data).bytes()


def level_png(width, height, bits, level):
    return png(width, height, bits, 0, (b"\0" + struct.pack(">H", level)[2 - bits // 8:] * width) * height)


def messages():
    depth = level_png(8, 6, 16, 1000)
    for cdr in (False, True):
        name = "cdr" if cdr else "ros1"
        for encoding in ("mono8", "16UC1", "32FC1", "rgb8", "bayer_rggb8", "yuv422"):
            yield f"valid_{encoding.lower()}_{name}", image_message(cdr, encoding=encoding, width=4, height=4)
        yield f"valid_camera_{name}", camera_message(cdr, D=(0.1, -0.2, 0.0, 0.0, 0.0), Tx=-7.0)
        yield f"valid_png_{name}", packed_message(cdr, "mono8; png compressed", level_png(4, 3, 8, 77))
    yield "valid_depth", packed_message(True, "32FC1; compressedDepth png", struct.pack("<I2f", 0, 10100.0, -1000.0) + depth)
    yield "valid_big_endian", image_message(True, big=True)
    yield "valid_rational", camera_message(False, model="rational_polynomial", D=(0.1,) * 8)
    yield "valid_fisheye", camera_message(False, model="equidistant", D=(0.1,) * 4)
    yield "valid_zeros", camera_message(False, focal=0.0, zeros=True)
    yield "valid_huge", image_message(False, width=1 << 31, height=1 << 31, step=8, data=b"")
    yield "bad_empty", b""
    yield "bad_torn", image_message(True)[:30]
    yield "bad_parameters", b"\0\3" + camera_message(True)[2:]


def street_messages(cdr):
    return [(f"/{side}/{name}", f"sensor_msgs/{kind}", 10 + second, data)
            for second in (0, 1) for side in ("left", "right")
            for name, kind, data in (("image_rect", "Image", image_message(cdr, 10 + second)),
                                     ("camera_info", "CameraInfo", camera_message(cdr, Tx=-7.0 if side == "right" else 0.0)))]


def ros1_record(data=b"", **fields):
    def sized(b):
        return struct.pack("<I", len(b)) + b
    return sized(b"".join(sized(name.encode() + b"=" + value) for name, value in fields.items())) + sized(data)


def ros1_bag(packing="none", pack=lambda b: b, version=b"2.0", index=5, size=None):
    records, known = b"", []
    for topic, kind, second, data in street_messages(False):
        if topic not in known:
            known.append(topic)
            words = [b"topic=" + topic.encode(), b"type=" + kind.encode()]
            records += ros1_record(b"".join(struct.pack("<I", len(w)) + w for w in words), op=b"\7",
                                   conn=struct.pack("<I", len(known) - 1), topic=topic.encode())
        records += ros1_record(data, op=b"\2", conn=struct.pack("<I", known.index(topic)), time=struct.pack("<2I", second, 0))
    chunk = ros1_record(pack(records), op=b"\5", compression=packing.encode(),
                        size=struct.pack("<I", len(records) if size is None else size))
    return b"#ROSBAG V" + version + b"\n" + ros1_record(b" " * 20, op=b"\3", index_pos=struct.pack("<Q", index)) + chunk


def mcap_record(op, content):
    return bytes([op]) + struct.pack("<Q", len(content)) + content


def mcap_file(packing="", pack=lambda b: b, magic=b"\x89MCAP0\r\n", is_chunked=True, crc=None):
    def text(t):
        return struct.pack("<I", len(t)) + t.encode()
    records, known = b"", []
    for topic, kind, second, data in street_messages(True):
        if topic not in known:
            known.append(topic)
            number = struct.pack("<H", len(known))
            records += mcap_record(3, number + text(kind.replace("/", "/msg/")) + text("ros2msg") + text(""))
            records += mcap_record(4, number + number + text(topic) + text("cdr") + text(""))
        time = struct.pack("<Q", second * 10**9)
        records += mcap_record(5, struct.pack("<HI", known.index(topic) + 1, 0) + time + time + data)
    packed = pack(records)
    chunk = mcap_record(6, struct.pack("<3QI", 0, 0, len(records), zlib.crc32(records) if crc is None else crc) +
                        text(packing) + struct.pack("<Q", len(packed)) + packed)
    return magic + mcap_record(1, text("ros2") + text("")) + (chunk if is_chunked else records) + \
        mcap_record(15, bytes(4)) + mcap_record(2, bytes(20)) + magic


def sqlite_file(tables=("topics", "messages")):
    connection = sqlite3.connect(":memory:")
    connection.execute("PRAGMA page_size = 512")
    connection.execute(f"CREATE TABLE {tables[0]}(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
    connection.execute(f"CREATE TABLE {tables[1]}(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
    names = []
    for topic, kind, second, data in street_messages(True):
        if topic not in names:
            names.append(topic)
            connection.execute(f"INSERT INTO {tables[0]} VALUES(?, ?, ?, 'cdr')", (len(names), topic, kind))
        connection.execute(f"INSERT INTO {tables[1]}(topic_id, timestamp, data) VALUES(?, ?, ?)",
                           (names.index(topic) + 1, second * 10**9, data))
    connection.commit()
    return connection.serialize()


def recordings():
    yield "valid_ros1", ros1_bag()
    yield "valid_ros1_bz2", ros1_bag("bz2", bz2.compress)
    yield "valid_ros1_unfinished", ros1_bag(index=0)
    yield "valid_ros1_torn", ros1_bag()[:-100]
    yield "valid_ros1_damaged_chunk", ros1_bag("bz2", lambda b: b[::-1])
    yield "valid_ros1_too_large", ros1_bag("bz2", bz2.compress, size=1 << 31)
    yield "bad_ros1_version", ros1_bag(version=b"1.2")
    yield "bad_ros1_packing", ros1_bag("rar")
    yield "valid_mcap", mcap_file()
    yield "valid_mcap_unchunked", mcap_file(is_chunked=False)
    yield "valid_mcap_wrong_crc", mcap_file(crc=5)
    yield "bad_mcap_version", mcap_file(magic=b"\x89MCAP7\r\n")
    yield "bad_mcap_packing", mcap_file("rar")
    yield "valid_sqlite", sqlite_file()
    yield "bad_sqlite_tables", sqlite_file(("other", "tables"))
    yield "bad_empty", b""


def write_all(out):
    seeds = {"pickle": pickles, "torch_zip": zips, "torch_legacy": legacy, "safetensors": safetensors_files,
             "coco_rle": codes, "image_container": images, "image_file": images_for_the_decoder, "number_file": number_files,
             "kitti_calibration": calibrations, "trajectory": trajectories, "class_names": class_lists,
             "frame_range": frame_ranges, "coco_annotations": coco_annotation_files,
             "coco_results": coco_result_files, "map_file": map_files, "cognitive_map": cognitive_map_files,
             "odometry_file": odometry_files,
             "plan_file": plan_files, "camera_file": camera_files, "image_list": image_lists, "euroc_ground_truth": euroc_ground_truths,
             "recording": recordings, "message": messages}
    for target, make in seeds.items():
        folder = out / target
        folder.mkdir(parents=True, exist_ok=True)
        for name, data in make():
            (folder / name).write_bytes(data)


if __name__ == "__main__":
    write_all(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "corpus")
