#!/usr/bin/python3
"""Trains the interest network: which class each cell of an image shows, and an embedding that is alike where two frames
show the same thing and unlike where they show another one of its class.

  train_interest.py --data out/landmarks --steps 1500 --out out/interest
  train_interest.py ... --no-attention       the ablation

  loss = cross entropy of the classes + contrast of cells / 2 + contrast of things

Contrast (InfoNCE, supervised) of unit embeddings e with temperature T, a mean over all a and all p of the same thing:
  -log( exp(e_a . e_p / T) / (exp(e_a . e_p / T) + sum over n of another thing w exp(e_a . e_n / T)) )
w = 1 where n has the class of a, else 0.05. Of cells, p is any other cell of the thing; of things, e is the mean over the
thing's cells in one image and p another image's, also of another round of the drive.

Run again with the same --out, it goes on from the last checkpoint. Writes checkpoint.pt, log.jsonl and
weights.safetensors, the mean of the weights over the last steps, to --out. Needs PyTorch and OpenCV.
"""
import argparse
import pathlib

import torch
from torch.nn import functional as F

import loop
import safetensors_file

from interest_data import IGNORED, Samples  # first: it knows where interest.py is
from interest import CLASSES, EPS, InterestNetwork

TEMPERATURE = 0.1
OTHER_CLASS = 0.05
CELLS_A_THING = 6  # drawn of each thing of an image
# Ground and sky fill half of an image; a sign a hundredth.
CLASS_WEIGHTS = (0.4, 2.5, 1.0, 5.0, 4.0, 0.8, 0.6, 1.5, 2.0, 0.8, 3.0)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, type=pathlib.Path, help="folder that make_landmarks.py wrote")
    loop.add_run_arguments(parser)
    parser.add_argument("--steps", type=int, default=1500)
    parser.add_argument("--groups", type=int, default=2, help="recordings a step")
    parser.add_argument("--frames", type=int, default=4, help="images of each")
    parser.add_argument("--room-share", type=float, default=0.25, help="of the steps")
    parser.add_argument("--learning-rate", type=float, default=3e-3)
    parser.add_argument("--weight-decay", type=float, default=0.02)
    parser.add_argument("--mean-over", type=int, default=200, help="steps that the averaged weights reach back")
    parser.add_argument("--attention", action=argparse.BooleanOptionalAction, default=True)
    parser.add_argument("--init", help="weights.safetensors to start from")
    parser.add_argument("--checkpoint-every", type=int, default=100, help="steps")
    return parser.parse_args()


def contrast(embedding, thing, its_class, image=None):
    """Mean over all pairs of one thing, of different images where `image` is given; and how often the nearest embedding
    of the class (of another image) is of the same thing."""
    same = thing[:, None] == thing
    pair = same & ~torch.eye(len(thing), dtype=torch.bool)
    if image is not None:
        pair &= image[:, None] != image
    similar = embedding @ embedding.T / TEMPERATURE
    weight = torch.where(its_class[:, None] == its_class, 1.0, OTHER_CLASS)
    others = torch.logsumexp(similar.masked_fill(same, -1e9) + weight.log(), 1, keepdim=True)
    losses = F.softplus(others - similar)[pair]
    with torch.no_grad():
        rivals = similar.masked_fill(~((its_class[:, None] == its_class) & (pair | ~same)), -1e9)
        found = same.gather(1, rivals.argmax(1, keepdim=True))[pair.any(1)]
    return losses.mean() if losses.numel() else similar.sum() * 0, found.float().mean() if found.numel() else torch.ones(())


def draw(thing_at, count, generator):
    """Places of at most `count` cells of each thing of each image: (image, cell)."""
    images, cells = thing_at.nonzero(as_tuple=True)
    order = torch.randperm(len(images), generator=generator)
    images, cells = images[order], cells[order]
    key = images * 2**32 + thing_at[images, cells]
    key, order = key.sort(stable=True)
    starts = torch.cat([torch.ones(1, dtype=torch.bool), key[1:] != key[:-1]])
    index = torch.arange(len(key))
    kept = order[index - index.where(starts, torch.zeros(())).cummax(0).values < count] if len(key) else order
    return images[kept], cells[kept]


def losses_of(outputs, classes, things, generator):
    logits, embedding = outputs
    parts = {"classes": F.cross_entropy(logits, classes, torch.tensor(CLASS_WEIGHTS), ignore_index=IGNORED)}
    embedding = F.normalize(embedding.flatten(2), dim=1).transpose(1, 2)  # [N, cells, channels]
    things, classes = things.flatten(1), classes.flatten(1)
    image, cell = draw(things, CELLS_A_THING, generator)
    cells, _ = contrast(embedding[image, cell], things[image, cell], classes[image, cell])
    parts["cells"] = 0.5 * cells
    # Means over the cells of each thing of an image.
    image, cell = things.nonzero(as_tuple=True)
    key, group = torch.unique(image * 2**32 + things[image, cell], return_inverse=True)
    sums = torch.zeros(len(key), embedding.shape[2]).index_add(0, group, embedding[image, cell])
    large = torch.bincount(group, minlength=len(key)) >= 3
    its_class = torch.zeros(len(key), dtype=torch.long).scatter(0, group, classes[image, cell])
    key, sums, its_class = key[large], sums[large], its_class[large]
    parts["things"], found = contrast(F.normalize(sums, dim=1), key % 2**32, its_class, key // 2**32)
    with torch.no_grad():
        known = classes.flatten() != IGNORED
        right = (logits.argmax(1).flatten() == classes.flatten())[known].float().mean()
    return parts, {"found": float(found), "right": float(right)}


class Training(loop.MeanLoop):
    def __init__(self, options):
        super().__init__(options, digits=4)
        self.samples = Samples(options.data, options.groups, options.frames, options.room_share, options.seed)
        torch.manual_seed(options.seed)
        model = InterestNetwork(attention=options.attention)
        if options.init:
            model.load_state_dict(safetensors_file.load(options.init)[0], strict=False)
        self.follow(model)
        parameters = list(self.model.parameters())
        self.optimizer = torch.optim.AdamW(
            [dict(params=[p for p in parameters if p.dim() > 1], weight_decay=options.weight_decay),
             dict(params=[p for p in parameters if p.dim() <= 1], weight_decay=0.0)], lr=options.learning_rate)
        self.resume()

    def one_step(self):
        images, classes, things = self.samples[self.step]
        for group in self.optimizer.param_groups:
            group["lr"] = loop.learning_rate(self.step, self.options.steps, self.options.learning_rate)
        generator = torch.Generator().manual_seed(self.options.seed * 1_000_003 + self.step)
        parts, facts = losses_of(self.model(images.contiguous(memory_format=torch.channels_last)), classes, things, generator)
        self.descend(parts, 5.0)
        if self.model.attention is not None:
            facts["gamma"] = float(self.model.attention.gamma.detach())
        return {**{name: float(value) for name, value in parts.items()}, **facts}

    def export(self):
        options = self.options
        safetensors_file.save(options.out / "weights.safetensors", self.mean,
                              dict(network="interest", batch_norm_eps=EPS, classes=",".join(CLASSES), seed=options.seed,
                                   training_data=options.data_name or options.data.name, steps=self.step,
                                   images_per_step=options.groups * options.frames))


def main():
    options = arguments()
    options.out.mkdir(parents=True, exist_ok=True)
    Training(options).run()


if __name__ == "__main__":
    main()
