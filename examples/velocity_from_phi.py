#!/usr/bin/env python3
"""Rebuilds the velocity of an OpenFOAM case from the fluxes through the faces and writes it into U:
    u = (sum_f n_f S_f^T)^-1 sum_f n_f phi_f    (n_f unit normal, S_f area vector of the cell's face f),
the formula of OpenFOAM's fvc::reconstruct, which is off in Debian's build (1912): potentialFoam's fluxes are right there,
the U it writes is not, on the boundary neither: values there are left out, and OpenFOAM makes them anew from the conditions.

    potentialFoam -case CASE -writephi
    velocity_from_phi.py CASE [TIME]        TIME: 0 if it is not given

Reads meshes as flowcage writes them (binary) and fields in either format. The conditions of U stay."""
import pathlib
import re
import sys

import numpy as np

LIST = rb"\s*(?:List<\w+>\s*)?(\d+)\s*\("


def numbers(data, at, kind, width=1):
    """The list that begins at or behind `at`, and where it ends; `kind` is the type of its binary numbers."""
    start = re.compile(LIST).search(data, at)
    count, begin = int(start.group(1)) * width, start.end()
    if re.search(rb"format\s+binary", data[:2000]):
        end = begin + count * np.dtype(kind).itemsize
        values = np.frombuffer(data[begin:end], kind)
    else:
        end = data.index(b"\n)", begin)
        values = np.array(re.sub(rb"[()]", b" ", data[begin:end]).split(), kind)
    if len(values) != count:
        sys.exit("velocity_from_phi.py: a list is shorter than it says")
    return values, end


def body(path):
    data = path.read_bytes()
    return data, data.index(b"}") + 1  # behind the header


def read_mesh(folder):
    data, at = body(folder / "points")
    points = numbers(data, at, "f8", 3)[0].reshape(-1, 3)
    data, at = body(folder / "faces")
    if b"faceCompactList" not in data[:2000]:
        sys.exit(f"velocity_from_phi.py: {folder}/faces is not binary: mesh it again with flowcage")
    at = numbers(data, at, "i4")[1]
    faces = numbers(data, at, "i4")[0].reshape(-1, 4)
    owner, neighbour = (numbers(*body(folder / name), "i4")[0] for name in ("owner", "neighbour"))
    boundary = re.findall(r"(\S+)\s*\{[^}]*nFaces\s+(\d+);\s*startFace\s+(\d+);", (folder / "boundary").read_text())
    return points, faces, owner, neighbour, [(name, int(count), int(first)) for name, count, first in boundary]


def read_fluxes(path, faces, inner, boundary):
    data, at = body(path)
    phi = np.zeros(faces)
    phi[:inner], at = numbers(data, data.index(b"internalField", at), "f8")
    for name, count, first in boundary:
        begin = re.compile(rb"\n\s*" + re.escape(name.encode()) + rb"\s*\{").search(data, at).end()
        value = re.compile(rb"value\s+(uniform\s+([^;]+);|nonuniform)|\}").search(data, begin)
        if value.group(2):
            phi[first:first + count] = float(value.group(2))
        elif value.group(1) and count:
            phi[first:first + count] = numbers(data, value.end(), "f8")[0]
    return phi


def main():
    case, time = pathlib.Path(sys.argv[1]), (sys.argv + ["0"])[2]
    points, faces, owner, neighbour, boundary = read_mesh(case / "constant/polyMesh")
    phi = read_fluxes(case / time / "phi", len(faces), len(neighbour), boundary)
    p = points[faces]
    area = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]) / 2
    normal = area / np.linalg.norm(area, axis=1, keepdims=True)
    cells = owner.max() + 1
    matrix, right = np.zeros((cells, 3, 3)), np.zeros((cells, 3))
    for side, count in ((owner, len(faces)), (neighbour, len(neighbour))):
        np.add.at(matrix, side, normal[:count, :, None] * area[:count, None, :])
        np.add.at(right, side, normal[:count] * phi[:count, None])
    velocity = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]

    path = case / time / "U"
    data, at = body(path)
    begin = data.index(b"internalField", at)
    uniform = re.compile(rb"internalField\s+uniform[^;]*;").match(data, begin)
    end = uniform.end() if uniform else data.index(b";", numbers(data, begin, "f8", 3)[1]) + 1
    binary = re.search(rb"format\s+binary", data[:2000])
    values = (velocity.astype("f8").tobytes() if binary else
              b"\n".join(b"(%r %r %r)" % tuple(row) for row in velocity.tolist()))
    field = b"internalField nonuniform List<vector>\n%d\n(%s%s);" % (cells, b"" if binary else b"\n", values)
    conditions = data[end:]
    while entry := re.search(rb"\n\s*value\s+nonuniform", conditions):
        stop = conditions.index(b";", numbers(data[:at] + conditions, at + entry.end(), "f8", 3)[1] - at) + 1
        conditions = conditions[:entry.start()] + conditions[stop:]
    path.write_bytes(data[:begin] + field + conditions)
    speed = np.linalg.norm(velocity, axis=1)
    print(f"U of {cells} cells: speed {speed.min():.6g} to {speed.max():.6g}")


if __name__ == "__main__":
    main()
