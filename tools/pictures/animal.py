#!/usr/bin/env python3
"""Writes the mesh of an animal that never lived: body, legs, trunk, ears, tusks and tail, blended, with wrinkles.

usage: animal.py OUT.off [CELL]

It is the model of the pictures in docs/: ours, and neither a sphere-mesh nor made of one. CELL is the side of the
cells that its surface is sampled in, 0.02 by default; the animal is about 2.6 long.
"""
import math
import sys

LOW, HIGH = (-1.10, -0.20, -0.72), (1.70, 1.50, 0.72)
# Chains of (x, y, z, radius): x forward, y up, z to the animal's right. Mirrored where z is not 0.
CHAINS = [
    [(-0.42, 0.78, 0, 0.34), (-0.02, 0.80, 0, 0.37), (0.38, 0.83, 0, 0.33)],
    [(0.38, 0.86, 0, 0.24), (0.76, 1.06, 0, 0.21), (0.86, 1.00, 0, 0.17)],
    [(0.86, 1.00, 0, 0.14), (1.10, 0.80, 0, 0.095), (1.18, 0.50, 0, 0.072), (1.30, 0.32, 0, 0.055), (1.48, 0.34, 0, 0.046),
     (1.55, 0.46, 0, 0.042)],
    [(0.36, 0.66, 0.20, 0.16), (0.46, 0.34, 0.23, 0.10), (0.42, 0.00, 0.24, 0.115)],
    [(-0.44, 0.66, 0.20, 0.18), (-0.38, 0.34, 0.23, 0.11), (-0.48, 0.00, 0.24, 0.115)],
    [(0.90, 0.93, 0.10, 0.048), (1.10, 0.80, 0.17, 0.040), (1.32, 0.86, 0.19, 0.026)],
    [(-0.72, 0.92, 0, 0.06), (-0.88, 0.62, 0, 0.028), (-0.92, 0.38, 0, 0.045)],
]
EAR = ((0.64, 1.02, 0.34), (0.22, 0.30, 0.062), 0.60)  # centre, radii, turn about the vertical
BLEND = 0.055


def segment(p, a, b):
    """Distance to the spheres between two, nearly; and how far along the nearest lies."""
    ab = [b[k] - a[k] for k in range(3)]
    ap = [p[k] - a[k] for k in range(3)]
    t = min(1.0, max(0.0, sum(map(float.__mul__, map(float, ap), map(float, ab))) / sum(x * x for x in ab)))
    return math.dist(ap, [t * x for x in ab]) - (a[3] + t * (b[3] - a[3])), t


def ear(p):
    """Distance to a flat ellipsoid, nearly."""
    centre, radii, turn = EAR
    x, y, z = (p[k] - centre[k] for k in range(3))
    x, z = math.cos(turn) * x + math.sin(turn) * z, -math.sin(turn) * x + math.cos(turn) * z
    scaled = math.hypot(x / radii[0], y / radii[1], z / radii[2])
    steep = math.hypot(x / radii[0] ** 2, y / radii[1] ** 2, z / radii[2] ** 2)
    return scaled * (scaled - 1) / steep if steep > 0 else -radii[2]


def blended(a, b):
    """The smaller, rounded where both are alike."""
    h = max(0.0, 1 - abs(a - b) / BLEND)
    return min(a, b) - h * h * BLEND / 4


def distance(p):
    """Below 0 inside the animal, about the distance to its surface elsewhere."""
    mirrored = (p[0], p[1], abs(p[2]))
    best = ear(mirrored)
    for chain in CHAINS:
        nearest = math.inf
        for i, (a, b) in enumerate(zip(chain, chain[1:])):
            d, t = segment(mirrored, a, b)
            if chain is CHAINS[2]:  # the trunk is ringed
                d += 0.006 * math.sin(14 * (i + t))
            nearest = min(nearest, d)
        best = blended(best, nearest)
    return best + 0.004 * math.sin(23 * p[0]) * math.sin(19 * p[1] + 5 * p[0]) * math.sin(21 * abs(p[2]))


def surface(cell):
    """A vertex for each cell that the surface passes, a quadrilateral for each edge of the grid that it crosses
    (Gibson 1998: surface nets)."""
    size = [math.ceil((HIGH[k] - LOW[k]) / cell) for k in range(3)]
    values = {}

    def value(i, j, k):
        key = (i, j, k)
        if key not in values:
            values[key] = distance((LOW[0] + i * cell, LOW[1] + j * cell, LOW[2] + k * cell))
        return values[key]

    # Blocks of cells too far from the surface are left out.
    block = 4
    reach = 2.2 * block * cell * math.sqrt(3) / 2 + 0.02
    corners = [(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]
    edges = [(p, q) for p in corners for q in corners if p < q and sum(map(abs, (p[k] - q[k] for k in range(3)))) == 1]
    positions, vertex_of = [], {}
    for bi in range(0, size[0], block):
        for bj in range(0, size[1], block):
            for bk in range(0, size[2], block):
                middle = [LOW[n] + (b + block / 2) * cell for n, b in enumerate((bi, bj, bk))]
                if abs(distance(middle)) > reach:
                    continue
                for i in range(bi, min(bi + block, size[0])):
                    for j in range(bj, min(bj + block, size[1])):
                        for k in range(bk, min(bk + block, size[2])):
                            sum_, crossings = [0.0, 0.0, 0.0], 0
                            for p, q in edges:
                                vp = value(i + p[0], j + p[1], k + p[2])
                                vq = value(i + q[0], j + q[1], k + q[2])
                                if (vp < 0) == (vq < 0):
                                    continue
                                t = vp / (vp - vq)
                                for n, base in enumerate((i, j, k)):
                                    sum_[n] += base + p[n] + t * (q[n] - p[n])
                                crossings += 1
                            if crossings:
                                vertex_of[i, j, k] = len(positions)
                                positions.append([LOW[n] + cell * sum_[n] / crossings for n in range(3)])
    faces = []
    for i, j, k in sorted(vertex_of):
        for axis in range(3):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            end = [i, j, k]
            end[axis] += 1
            inside, outside = value(i, j, k) < 0, value(*end) < 0
            if inside == outside:
                continue
            ring = []
            for du, dv in ((0, 0), (-1, 0), (-1, -1), (0, -1)):
                at = [i, j, k]
                at[u] += du
                at[v] += dv
                ring.append(vertex_of.get(tuple(at)))
            if None not in ring:
                faces.append(ring if inside else ring[::-1])
    return positions, faces


def main(arguments):
    if arguments[1:] in (["-h"], ["--help"]):
        print(__doc__)
        return 0
    if not 2 <= len(arguments) <= 3 or arguments[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    positions, faces = surface(float(arguments[2]) if len(arguments) == 3 else 0.02)
    with open(arguments[1], "w", encoding="ascii") as out:
        out.write(f"OFF\n{len(positions)} {len(faces)} 0\n")
        out.writelines(f"{x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in positions)
        out.writelines(f"4 {a} {b} {c} {d}\n" for a, b, c, d in faces)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
