#!/usr/bin/python3
"""Trains Mask R-CNN, baseline or with mixed attention, on a COCO-format data set and writes weights for Penumbra.

  train.py --annotations street/instances.json --images street --val-annotations val/instances.json --val-images val \\
           --attention --seed 1 --out out/attention_1
  train.py ... --variants baseline,spatial,channel,spatial-channel,channel-spatial --seeds 1-5 --out out/table

The second trains one network after the other, seed by seed, each to a folder of --out: out/table/spatial_3.
Run again with the same --out, it goes on from the last checkpoint: order of the images, changes to them and samples
drawn depend on the seed and the step alone. Writes to --out:
  checkpoint.pt            everything needed to go on
  log.jsonl                losses and speed
  weights.safetensors      the network, for `penumbra segment`, `slam` and this script's --init
  ap.json                  COCO numbers on the validation set, by `penumbra eval-coco` (with --val-annotations)

The first run decodes the data set to one file, beside the annotations or where --packed says; later ones map it.
Needs Debian's python3-torch, python3-torchvision, python3-opencv, or PyPI's torch 2, torchvision, opencv-python-headless.
Uses a GPU where PyTorch has one. Convolutions are of 16 bits (bf16) where the machine has an instruction for them.
"""
import argparse
import contextlib
import copy
import pathlib
import signal
import sys

import torch

import evaluate
import evaluate_in_python
import loop
from batches import Batches
from coco_data import CocoData
from config import CONFIGS
from detection_losses import DetectionLosses
from export import export
from initial_weights import load_initial
from model import OF_ENGINE, VARIANTS, SemanticHead, build
from packed_data import PackedData


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    seeds = loop.add_arguments(parser)
    seeds.add_argument("--seeds", type=numbers, help="several seeds, one after the other: 1-5 or 1,2,7")
    parser.add_argument("--packed", type=pathlib.Path, help="file of the decoded images; default: beside the annotations")
    parser.add_argument("--config", choices=CONFIGS, default="tiny")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--attention", action="store_true", help="mixed attention in the pyramid; else the baseline")
    kind.add_argument("--variants", help="several kinds of network, one after the other: " + ",".join(VARIANTS))
    parser.add_argument("--device", help="cpu or cuda; default: cuda where there is one")
    parser.add_argument("--precision", choices=("auto", "f32", "bf16"), default="auto",
                        help="of convolutions; auto: bf16 on a GPU and on processors with AMX or AVX512_BF16")
    parser.add_argument("--val-annotations", help="validation set")
    parser.add_argument("--val-images")
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--batch", type=int, help="images a step")
    parser.add_argument("--learning-rate", type=float)
    parser.add_argument("--scale", type=float, default=1.0,
                        help="train on images of this scale; half the size costs a quarter, for the first steps")
    parser.add_argument("--grey", type=float, default=0.15, help="share of images without colour, for grey cameras")
    parser.add_argument("--gate-rate", type=float, default=0.1, help="learning rate of the attention, times the others'")
    parser.add_argument("--weight-decay", type=float, default=0.01)
    parser.add_argument("--init", help="weights to start from: torchvision's .pth or a checkpoint.pt of this script")
    parser.add_argument("--checkpoint-every", type=int, default=100, help="steps")
    parser.add_argument("--penumbra", default=evaluate.PENUMBRA, help="for the validation")
    return parser.parse_args()


def numbers(text):
    """1-3,7 as [1, 2, 3, 7]."""
    found = []
    for part in text.split(","):
        first, dash, last = part.partition("-")
        span = range(int(first), int(last if dash else first) + 1)
        if not span:
            raise argparse.ArgumentTypeError(f"{part} has no number in it; the smaller one stands first")
        found += span
    return found


def parameter_groups(model, semantic, gate_rate, weight_decay):
    """Norms and biases do not decay; the attention has its own learning rate."""
    groups = {}
    for name, parameter in list(model.named_parameters()) + list(semantic.named_parameters()):
        if parameter.requires_grad:
            key = (gate_rate if ".attention." in name else 1.0, weight_decay if parameter.dim() > 1 else 0.0)
            groups.setdefault(key, []).append(parameter)
    return [dict(params=p, rate=rate, weight_decay=decay) for (rate, decay), p in groups.items()]


def has_bf16(device):
    """Whether `device` multiplies numbers of 16 bits faster than those of 32."""
    if device.type == "cuda":  # is_bf16_supported() would count GPUs that only emulate it
        return bool(torch.version.hip) or torch.cuda.get_device_capability(device)[0] >= 8
    file = pathlib.Path("/proc/cpuinfo")
    words = set(file.read_text().split()) if file.exists() else set()
    return int(torch.__version__.split(".")[0]) >= 2 and bool(words & {"amx_bf16", "avx512_bf16"})


def adam(groups, rate):
    """AdamW in one pass over each weight where PyTorch has that."""
    try:
        return torch.optim.AdamW(groups, lr=rate, fused=True)
    except (TypeError, RuntimeError):  # before 2.0 on a GPU, before 2.4 on a processor
        return torch.optim.AdamW(groups, lr=rate)


def packed(options):
    """The data set, decoded once for all trainings."""
    config = CONFIGS[options.config]
    sides = [round(side * options.scale) for side in (config.min_size, config.max_size)]
    data = CocoData(options.annotations, options.images, config.classes, sides=sides)
    print(f"{len(data)} images with {data.instances} objects", file=sys.stderr)
    return PackedData(data, options.annotations, options.packed or pathlib.Path(options.annotations).with_suffix(".packed"))


class Training(loop.Loop):
    def __init__(self, options, data):
        super().__init__(options, digits=4)
        self.config = CONFIGS[options.config]
        self.device = torch.device(options.device or ("cuda" if torch.cuda.is_available() else "cpu"))
        self.bf16 = options.precision == "bf16" or options.precision == "auto" and has_bf16(self.device)
        self.peak = options.learning_rate or self.config.learning_rate
        self.batches = Batches(data, options.batch or self.config.batch, options.seed, options.grey)
        torch.manual_seed(options.seed)
        self.model = build(self.config, options.variant)
        if options.init:
            load_initial(self.model, options.init)
        torch.manual_seed(options.seed)  # the same for either kind of network
        self.semantic = SemanticHead(self.model.backbone.fpn, self.config.pyramid_channels, self.config.outputs)
        self.model.to(self.device, memory_format=torch.channels_last).train()
        self.semantic.to(self.device)
        self.optimizer = adam(parameter_groups(self.model, self.semantic, options.gate_rate, options.weight_decay), self.peak)
        self.detection_losses = DetectionLosses(self.model)
        self.resume()

    def kept(self):
        return dict(model=self.model, semantic=self.semantic, optimizer=self.optimizer)

    def noted(self):
        return dict(attention=self.options.variant, config=self.config.name)

    def losses(self, batch):
        with torch.autocast(self.device.type, torch.bfloat16) if self.bf16 else contextlib.nullcontext():
            losses = self.detection_losses(batch)
            if self.config.semantic_weight > 0:
                losses["loss_semantic"] = self.config.semantic_weight * self.semantic.loss(batch.classes)
        return losses

    def one_step(self):
        torch.manual_seed(self.options.seed * 1000003 + self.step)  # which anchors and proposals are sampled
        rate = loop.learning_rate(self.step, self.options.steps, self.peak)
        for group in self.optimizer.param_groups:
            group["lr"] = rate * group["rate"]
        losses = self.losses(self.batches[self.step].to(self.device))
        total = sum(losses.values())
        self.optimizer.zero_grad(set_to_none=True)
        if torch.isfinite(total):
            total.backward()
            torch.nn.utils.clip_grad_norm_(self.model.parameters(), 5.0)
            self.optimizer.step()
        self.step += 1
        return {name: value.detach() for name, value in losses.items()}

    def finish(self):
        """Writes the weights; validates them and notes their AP in their metadata."""
        options = self.options
        weights = options.out / "weights.safetensors"
        facts = dict(training_data=options.data_name or pathlib.Path(options.annotations).stem, seed=options.seed, steps=options.steps,
                     images_per_step=self.batches.size)
        export(weights, self.model, self.config, options.variant, **facts)
        if not options.val_annotations:
            return
        judged = options.penumbra, weights, options.val_annotations, options.val_images, options.out
        in_python = options.in_python
        report = evaluate_in_python.evaluate(*judged, options.config) if in_python else evaluate.evaluate(*judged)
        evaluate.stamp(weights, report)
        print(evaluate.summary(report))


def runs(options):
    """The options of every training that is asked for, in pairs: all variants of a seed, then the next seed."""
    usual = "spatial-channel" if options.attention else "baseline"
    variants = options.variants.split(",") if options.variants else [usual]
    unknown = set(variants) - set(VARIANTS)
    if unknown:
        raise SystemExit(f"--variants: no {', '.join(sorted(unknown))}; there are {', '.join(VARIANTS)}")
    for seed in options.seeds or [options.seed]:
        for variant in variants:
            one = copy.copy(options)
            one.seed, one.variant = seed, variant
            one.in_python = not set(variants) <= set(OF_ENGINE)  # what the engine refuses: then one judge for all
            if options.variants or options.seeds:
                one.out = options.out / f"{variant}_{seed}"
            yield one


def main():
    options = arguments()
    signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))  # as an exception, so that files are cleared up
    trainings, data = list(runs(options)), packed(options)
    for one in trainings:
        one.out.mkdir(parents=True, exist_ok=True)
        training = Training(one, data)
        training.run()
        training.finish()


if __name__ == "__main__":
    main()
