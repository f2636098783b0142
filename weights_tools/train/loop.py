"""What every training here does: steps, checkpoints from which it goes on, a log."""
import json
import math
import os
import pathlib
import sys
import time

import torch


def add_arguments(parser):
    parser.add_argument("--annotations", required=True, help="training set, COCO instances JSON")
    parser.add_argument("--images", required=True, help="folder that its file names refer to")
    return add_run_arguments(parser)


def add_run_arguments(parser):
    """Returns the group of --seed, to which other ways of naming seeds can be added."""
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--stop", type=int, help="stop after this step of the schedule; run again to go on")
    parser.add_argument("--data-name", default="", help="what the training data is, for the weights' metadata")
    seeds = parser.add_mutually_exclusive_group()
    seeds.add_argument("--seed", type=int, default="1")  # as text, from which argparse tells a 1 that was given
    return seeds


def learning_rate(step, steps, peak):
    """Rises for the first twentieth, then falls along a cosine to a hundredth."""
    warm_up = max(1, steps // 20)
    if step < warm_up:
        return peak * (step + 1) / warm_up
    return peak * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * (step - warm_up) / max(1, steps - warm_up))))


class Loop:
    """A training has one_step(), which returns its losses by name, and kept(), what a checkpoint holds by name: modules
    and optimizers. `digits`: of the losses in the log."""

    def __init__(self, options, digits):
        self.options, self.digits = options, digits
        self.step, self.seconds = 0, 0.0
        self.checkpoint = options.out / "checkpoint.pt"

    def noted(self):
        """Plain values that a checkpoint holds as well."""
        return {}

    def resume(self):
        """Goes on from the checkpoint; its content, or nothing where there is none."""
        if not self.checkpoint.exists():
            return None
        saved = torch.load(self.checkpoint, map_location="cpu")
        for name, part in self.kept().items():
            part.load_state_dict(saved[name])
        self.step, self.seconds = saved["step"], saved["seconds"]
        print(f"going on from step {self.step}", file=sys.stderr)
        return saved

    def save(self):
        part = self.checkpoint.with_suffix(".part")
        torch.save(dict({name: part.state_dict() for name, part in self.kept().items()}, step=self.step,
                        seconds=self.seconds, **self.noted()), part)
        os.replace(part, self.checkpoint)

    def run(self):
        sums, counted, last = {}, 0, min(self.options.steps, self.options.stop or self.options.steps)
        while self.step < last:
            start = time.monotonic()
            losses = self.one_step()
            self.seconds += time.monotonic() - start
            sums = {name: sums.get(name, 0.0) + value for name, value in losses.items()}
            counted += 1
            if self.step % 20 == 0 or self.step == last:
                self.report({name: float(value) / counted for name, value in sums.items()})
                sums, counted = {}, 0
            if self.step % self.options.checkpoint_every == 0 or self.step == last:
                self.save()

    def report(self, losses):
        line = dict(step=self.step, seconds=round(self.seconds, 1), **{n: round(v, self.digits) for n, v in losses.items()})
        with open(self.options.out / "log.jsonl", "a") as file:
            file.write(json.dumps(line) + "\n")
        left = self.seconds / self.step * (self.options.steps - self.step)
        print(f"{self.step}/{self.options.steps}, {left / 60:.1f} min left, "
              + ", ".join(f"{n.removeprefix('loss_')} {v:.{self.digits - 1}f}" for n, v in losses.items()),
              file=sys.stderr, flush=True)


class MeanLoop(Loop):
    """A training of one model, of which the mean over the last steps' weights is kept and exported. It sets self.model,
    and self.optimizer before resume(), and has export()."""

    def follow(self, model):
        """Begins with `model`."""
        self.model = model.to(memory_format=torch.channels_last).train()
        self.mean = {name: value.clone() for name, value in self.model.state_dict().items()}

    def kept(self):
        return dict(model=self.model, optimizer=self.optimizer)

    def noted(self):
        return dict(mean=self.mean)

    def resume(self):
        saved = super().resume()
        if saved:
            self.mean = saved["mean"]
        return saved

    def save(self):
        super().save()
        self.export()

    def descend(self, parts, largest_gradient):
        """One step down the sum of the losses, and of the mean towards where it leads."""
        self.optimizer.zero_grad(set_to_none=True)
        sum(parts.values()).backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), largest_gradient)
        self.optimizer.step()
        self.step += 1
        keep = 1 - 1 / min(1 + self.step / 4, self.options.mean_over)  # early weights are soon forgotten
        for name, value in self.model.state_dict().items():
            if value.is_floating_point():
                self.mean[name].mul_(keep).add_(value, alpha=1 - keep)
