#!/usr/bin/env python3
"""Draws the three cases of the dual static-point constraint: static-points-cases.svg.

    python3 docs/images/make_static_points_cases.py docs/images/static-points-cases.svg

The numbers are those of docs/dynamics/static-points.md: a camera of f = 525 pixels sees S at (0.3, -0.2, 2.5) m and
goes 0.2 m to the right. Above, the two from the side; below, the picture around S2, magnified.
"""
import math
import sys

F, S, RIGHT = 525.0, (0.3, -0.2, 2.5), 0.2
WIDTH, SIDE, CLOSE, GAP = 290, 130, 190, 24  # pixels of a panel, of its two pictures, and between


def seen_at(p):
    """Pixel of a point in the second view, from the image's centre."""
    return F * (p[0] - RIGHT) / p[2], F * p[1] / p[2]


def along_ray(p, metres):
    k = (p[2] + metres) / p[2]
    return RIGHT + (p[0] - RIGHT) * k, p[1] * k, p[2] + metres


S2 = seen_at(S)
# Name, where the point is, how far its match lies from where it is seen, its depth as measured, the verdict.
CASES = [
    ("noise", S, (0.62, -0.5), S[2] + 0.02, "stands"),
    ("off the line", (S[0], S[1] - 0.08, S[2]), (0.0, 0.0), S[2], "moves: D"),
    ("along the axis", along_ray(S, 0.3), (0.0, 0.0), S[2] + 0.3, "moves: \u0394z"),
]
GREY, BLUE, RED, GREEN = "#999", "#1f77b4", "#d62728", "#2ca02c"


def line(a, b, colour, more=""):
    return '<line x1="%.1f" y1="%.1f" x2="%.1f" y2="%.1f" stroke="%s" %s/>' % (*a, *b, colour, more)


def disc(p, colour, hollow=False):
    fill, edge = ("white", colour) if hollow else (colour, "none")
    return '<circle cx="%.1f" cy="%.1f" r="5" fill="%s" stroke="%s" stroke-width="1.5"/>' % (*p, fill, edge)


def text(p, words, more=""):
    return '<text x="%.1f" y="%.1f" %s>%s</text>' % (*p, more, words)


def from_the_side(point):
    """Camera, its ray to S, S and where it went. Heights are drawn three times as large as lengths."""
    def at(p):
        return 30 + 80.0 * p[2], 112 + 240.0 * p[1]
    camera, before, now = at((0, 0, 0)), at(S), at(point)
    far = at(along_ray(S, 0.5))
    parts = [line(camera, far, GREY, 'stroke-dasharray="3 3"'), disc(before, BLUE, hollow=True), disc(now, RED)]
    parts.append('<path d="M%.1f %.1f l-14 -8 v16 z" fill="#444"/>' % (camera[0] + 4, camera[1]))
    if point != S:
        parts.append(line(before, now, RED, 'stroke-width="1.5"'))
        parts.append(text((before[0] - 14, before[1] + 18), "S"))
    else:
        parts.append(text((before[0] - 14, before[1] + 18), "S stays"))
    return parts


def close_up(point, noise, z2):
    """The picture around S2: the epipolar line, level, S2 and S2'. The bars below are the depths."""
    where = seen_at(point)
    off = (where[0] + noise[0] - S2[0], where[1] + noise[1] - S2[1])
    scale = 24.0 if math.hypot(*off) < 3 else 5.0  # pixels on paper a pixel
    middle = (145.0, 118.0)
    now = (middle[0] + scale * off[0], middle[1] + scale * off[1])
    parts = ['<rect x="10" y="8" width="270" height="132" fill="none" stroke="#ccc"/>',
             line((10, middle[1]), (280, middle[1]), BLUE), text((14, middle[1] - 5), "line of S", 'fill="%s"' % BLUE)]
    if abs(off[1]) > 1e-6:
        parts.append(line((now[0], now[1]), (now[0], middle[1]), RED, 'stroke-dasharray="4 2" stroke-width="1.5"'))
    parts += [disc(middle, BLUE, hollow=True), disc(now, RED)]
    parts.append(text((middle[0] + 10, middle[1] + 17), "S2"))
    parts.append(text((now[0] + 10, now[1] - 6), "S2'"))
    parts.append(text((14, 24), "one pixel:"))
    parts.append(line((80, 20), (80 + scale, 20), "black", 'stroke-width="2"'))
    for y, name, z, colour in ((156, "z1", S[2], BLUE), (172, "z2", z2, RED)):
        parts.append(text((14, y + 4), "%s = %.2f m" % (name, z)))
        parts.append('<rect x="100" y="%d" width="%.1f" height="8" fill="%s"/>' % (y - 4, 60 * z, colour))
    d, shift, dz = abs(off[1]), math.hypot(*off), abs(z2 - S[2])
    return parts, "D %.1f, \u0394d %.1f pixels, \u0394z %.2f m" % (d, shift, dz)


def main():
    height = 30 + SIDE + CLOSE + 44
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" font-family="sans-serif" font-size="12">'
             % (len(CASES) * (WIDTH + GAP), height), '<rect width="100%" height="100%" fill="white"/>']
    for i, (name, point, noise, z2, verdict) in enumerate(CASES):
        parts.append('<g transform="translate(%d 0)">' % (i * (WIDTH + GAP) + GAP // 2))
        parts.append(text((10, 20), name, 'font-size="15" font-weight="bold"'))
        parts += ['<g transform="translate(0 26)">', *from_the_side(point), "</g>"]
        shown, figures = close_up(point, noise, z2)
        parts += ['<g transform="translate(0 %d)">' % (26 + SIDE), *shown, "</g>"]
        parts.append(text((10, 26 + SIDE + CLOSE + 12), figures))
        parts.append(text((10, 26 + SIDE + CLOSE + 32), verdict, 'font-weight="bold" fill="%s"' %
                          (GREEN if verdict == "stands" else RED)))
        parts.append("</g>")
    parts.append("</svg>\n")
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write("\n".join(parts))


if __name__ == "__main__":
    main()
