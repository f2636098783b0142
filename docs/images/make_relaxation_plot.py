#!/usr/bin/env python3
"""Draws how a cognitive map relaxes by the paper's rule and by the mean of a node's links: brain-relaxation.svg.

    python3 docs/images/make_relaxation_plot.py docs/images/brain-relaxation.svg

A loop of 40 nodes a metre apart, with a drift of 0.1 m a step that one link takes back. Left each node has the two
links of its way; right it also knows the nodes two steps on, as a place that is recalled often does: four links.
Headings are right, so this is (21, 22) alone: the sum of a node's links, nodes moved one after the other or all at
once, beside their mean. Drawn is the root mean square of what the links are off, on a
logarithmic scale.
"""
import math
import sys

NODES, RHO, SWEEPS = 40, 0.6, 60
WIDTH, HEIGHT, LEFT, TOP, BOTTOM = 380, 300, 60, 40, 46
COLOURS = {"sum, in turn": "#d62728", "sum, at once": "#ff9896", "mean, in turn": "#1f77b4"}


def loop(steps):
    """Poses with drift, and links (from, to, way) that are right."""
    turn = 2.0 * math.pi / NODES
    true = [(NODES / (2.0 * math.pi) * math.cos(turn * i), NODES / (2.0 * math.pi) * math.sin(turn * i))
            for i in range(NODES)]
    links = [(i, (i + s) % NODES) for i in range(NODES) for s in steps]
    links = [(a, b, (true[b][0] - true[a][0], true[b][1] - true[a][1])) for a, b in links]
    return [(x + 0.1 * i, y) for i, (x, y) in enumerate(true)], links


def off(poses, links):
    sums = sum((poses[b][k] - poses[a][k] - way[k]) ** 2 for a, b, way in links for k in (0, 1))
    return math.sqrt(sums / len(links))


def sweep(poses, links, mode):
    what, order = mode.split(", ")
    moved = list(poses)
    for i in range(1, len(poses)):  # the first node stays
        seen = moved if order == "in turn" else poses
        pull, count = [0.0, 0.0], 0
        for a, b, way in links:
            if i in (a, b):
                sign, count = (1.0 if i == a else -1.0), count + 1
                for k in (0, 1):
                    pull[k] += sign * (seen[b][k] - seen[a][k] - way[k])
        rate = RHO / count if what == "mean" else RHO
        moved[i] = (seen[i][0] + rate * pull[0], seen[i][1] + rate * pull[1])
    return moved


def panel(left, steps, title):
    low, high = -2.0, 4.0
    width, height = WIDTH - LEFT - 10, HEIGHT - TOP - BOTTOM

    def at(n, value):
        level = min(high, max(low, math.log10(max(value, 1e-9))))
        return left + LEFT + width * n / SWEEPS, TOP + height * (high - level) / (high - low)

    parts = ['<text x="%d" y="22" font-weight="bold">%s</text>' % (left + LEFT, title)]
    for power in range(int(low), int(high) + 1, 2):
        x, y = at(0, 10.0 ** power)
        parts.append('<line x1="%.1f" y1="%.1f" x2="%.1f" y2="%.1f" stroke="#ddd"/>' % (x, y, x + width, y))
        parts.append('<text x="%.1f" y="%.1f" text-anchor="end">%g m</text>' % (x - 6, y + 4, 10.0 ** power))
    for n in range(0, SWEEPS + 1, 20):
        parts.append('<text x="%.1f" y="%d" text-anchor="middle">%d</text>' % (at(n, 1)[0], HEIGHT - BOTTOM + 18, n))
    parts.append('<text x="%.1f" y="%d" text-anchor="middle">sweeps</text>' % (left + LEFT + width / 2, HEIGHT - 8))
    for mode, colour in COLOURS.items():
        poses, links = loop(steps)
        points = []
        for n in range(SWEEPS + 1):
            value = off(poses, links)
            points.append("%.1f,%.1f" % at(n, value))
            if value > 10.0 ** high:
                break
            poses = sweep(poses, links, mode)
        parts.append('<polyline points="%s" fill="none" stroke="%s" stroke-width="2"/>' % (" ".join(points), colour))
    return parts


def main(path):
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" font-family="sans-serif" font-size="12">'
             % (2 * WIDTH, HEIGHT + 20), '<rect width="100%" height="100%" fill="white"/>']
    parts += panel(0, (1,), "two links a node") + panel(WIDTH, (1, 2), "four links a node")
    for n, (mode, colour) in enumerate(COLOURS.items()):
        parts.append('<text x="%d" y="%d" fill="%s">%s</text>' % (LEFT + 160 * n, HEIGHT + 14, colour, mode))
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(parts + ["</svg>"]) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
