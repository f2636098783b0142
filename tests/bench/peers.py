#!/usr/bin/env python3
"""Mask R-CNN R50-FPN in ONNX Runtime and in PyTorch, for bench_targets, which runs this file:

  peers.py torch --threads N             answers each line "backbone" or "full" with the processor's seconds of one run
  peers.py onnxruntime --threads N [--model MODEL.onnx]     the same; "full" needs the model that `export` has made
  peers.py export FOLDER                 with PyTorch: mask_rcnn.onnx, mask_rcnn.pth and image.png, of random weights
  peers.py first FOLDER --threads N      with PyTorch: from the start of a process to the first detections

The first line of an answer is JSON: the versions, or {"missing": ...} where a module is not installed, and exit status 3.
Random weights would find nothing: one class gets a large bias, so that 100 instances go through the mask head.
"""
import argparse
import json
import os
import sys
import time
import warnings

HEIGHT, WIDTH = 375, 1242  # of the image; 416 x 1344 at the network
DETECTIONS = 100


def mask_rcnn():
    import torch
    import torchvision
    torch.manual_seed(1)
    model = torchvision.models.detection.maskrcnn_resnet50_fpn(
        weights=None, weights_backbone=None, box_detections_per_img=DETECTIONS).eval()
    with torch.no_grad():
        model.roi_heads.box_predictor.cls_score.bias[1] = 5.0
    return model


def answer(works):
    """Runs what each line of the standard input asks for; two runs of each come first and do not count."""
    for work in works.values():
        work()
        work()
    for line in sys.stdin:
        begin = time.process_time()
        works[line.strip()]()
        print(time.process_time() - begin, flush=True)


def serve_torch(threads):
    import torch
    import torchvision
    torch.set_num_threads(threads)
    model = mask_rcnn()
    image = torch.rand(3, HEIGHT, WIDTH)
    with torch.inference_mode():
        resized, _ = model.transform([image])
        found = len(model([image])[0]["scores"])
        print(json.dumps({"torch": torch.__version__, "torchvision": torchvision.__version__, "detections": found,
                          "runs": ["backbone", "full"]}), flush=True)
        answer({"backbone": lambda: model.backbone(resized.tensors), "full": lambda: model([image])})


def export(folder):
    import torch
    import torchvision
    model = mask_rcnn()
    image = torch.rand(3, HEIGHT, WIDTH)
    torch.save(model.state_dict(), os.path.join(folder, "mask_rcnn.pth"))
    torchvision.io.write_png((image * 255).to(torch.uint8), os.path.join(folder, "image.png"))
    torch.onnx.export(model, ([image],), os.path.join(folder, "mask_rcnn.onnx"), opset_version=11,
                      do_constant_folding=True, input_names=["image"])
    print("{}")


def first_detections(folder, threads):
    import torch
    import torchvision
    torch.set_num_threads(threads)
    model = torchvision.models.detection.maskrcnn_resnet50_fpn(
        weights=None, weights_backbone=None, box_detections_per_img=DETECTIONS).eval()
    model.load_state_dict(torch.load(os.path.join(folder, "mask_rcnn.pth")))
    image = torchvision.io.read_image(os.path.join(folder, "image.png")).float() / 255
    with torch.inference_mode():
        print(json.dumps({"detections": len(model([image])[0]["scores"])}))


def backbone_model(height, width):
    """ResNet-50 with its pyramid for inputs of height x width, batch norms folded, random weights: ONNX's bytes."""
    import numpy
    import onnx
    from onnx import TensorProto, helper, numpy_helper
    random = numpy.random.default_rng(0)
    nodes, weights = [], []

    def node(kind, inputs, name, **attributes):
        nodes.append(helper.make_node(kind, inputs, [name], **attributes))
        return name

    def convolution(x, name, inputs, outputs, kernel, stride=1, relu=True, residual=None):
        scale = (2.0 / (inputs * kernel * kernel)) ** 0.5
        weight = (random.standard_normal((outputs, inputs, kernel, kernel)) * scale).astype(numpy.float32)
        weights.append(numpy_helper.from_array(weight, name + ".weight"))
        weights.append(numpy_helper.from_array(numpy.zeros(outputs, numpy.float32), name + ".bias"))
        y = node("Conv", [x, name + ".weight", name + ".bias"], name, kernel_shape=[kernel, kernel],
                 strides=[stride, stride], pads=[kernel // 2] * 4)
        if residual is not None:
            y = node("Add", [y, residual], name + ".sum")
        return node("Relu", [y], name + ".relu") if relu else y

    x = convolution("input", "stem", 3, 64, 7, 2)
    x = node("MaxPool", [x], "pool", kernel_shape=[3, 3], strides=[2, 2], pads=[1] * 4)
    channels, stages = 64, []
    for stage, blocks in enumerate([3, 4, 6, 3]):
        middle = 64 << stage
        for block in range(blocks):
            stride = 2 if block == 0 and stage > 0 else 1
            name = f"layer{stage + 1}.{block}"
            shortcut = x if block else convolution(x, name + ".down", channels, 4 * middle, 1, stride, relu=False)
            y = convolution(x, name + ".1", channels, middle, 1)
            y = convolution(y, name + ".2", middle, middle, 3, stride)
            x = convolution(y, name + ".3", middle, 4 * middle, 1, residual=shortcut)
            channels = 4 * middle
        stages.append((x, channels, height >> (stage + 2), width >> (stage + 2)))
    above, outputs = None, []
    for level, (x, channels, h, w) in reversed(list(enumerate(stages))):
        y = convolution(x, f"inner{level}", channels, 256, 1, relu=False)
        if above is not None:
            weights.append(numpy_helper.from_array(numpy.array([1, 256, h, w], numpy.int64), f"size{level}"))
            above = node("Resize", [above, "", "", f"size{level}"], f"up{level}", mode="nearest",
                         coordinate_transformation_mode="asymmetric", nearest_mode="floor")
            y = node("Add", [y, above], f"sum{level}")
        above = y
        outputs.append(convolution(y, f"P{level + 2}", 256, 256, 3, relu=False))
    graph = helper.make_graph(
        nodes, "backbone", [helper.make_tensor_value_info("input", TensorProto.FLOAT, [1, 3, height, width])],
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, None) for name in outputs], weights)
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8).SerializeToString()


def serve_onnxruntime(threads, model):
    import numpy
    import onnx  # that it is missing is said before anything else
    import onnxruntime
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")  # processor time counts
    options.log_severity_level = 3

    def work(source, shape):
        session = onnxruntime.InferenceSession(source, options, providers=["CPUExecutionProvider"])
        image = {session.get_inputs()[0].name: numpy.random.default_rng(1).random(shape, numpy.float32)}
        return lambda: session.run(None, image)

    works = {"backbone": work(backbone_model(416, 1344), (1, 3, 416, 1344))}
    facts = {"onnxruntime": onnxruntime.__version__, "onnx": onnx.__version__}
    if model:
        works["full"] = work(model, (3, HEIGHT, WIDTH))
        facts["detections"] = len(works["full"]()[0])
    print(json.dumps(facts | {"runs": list(works)}), flush=True)
    answer(works)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["torch", "onnxruntime", "export", "first"])
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--model")
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # of the exporter, about the network's own code
    try:
        if options.what == "torch":
            serve_torch(options.threads)
        elif options.what == "onnxruntime":
            serve_onnxruntime(options.threads, options.model)
        elif options.what == "export":
            export(options.folder)
        else:
            first_detections(options.folder, options.threads)
    except ImportError as error:
        print(json.dumps({"missing": str(error)}), flush=True)
        sys.exit(3)


if __name__ == "__main__":
    main()
