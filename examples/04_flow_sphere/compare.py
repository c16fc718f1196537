#!/usr/bin/env python3
"""Potential flow round a sphere, solved by OpenFOAM on three meshes of the same body, first height and number of cells:
flowcage's, snappyHexMesh's with layers, and a blockMesh O-grid written by hand. Prints how far the velocity is from
the exact one within one diameter of the sphere.

    compare.py [FOLDER] [--levels N] [--first-height H] [--check] [--snappy L2 MAX] [--ogrid L2 MAX]

The sphere has diameter 1 and lies in a uniform flow of speed 1 along x; the far field is 10 diameters away and carries
the exact potential (Dirichlet). Laplacian: `Gauss linear corrected` with 10 non-orthogonal correctors. The velocity of a
cell is rebuilt in two ways: as the leastSquares gradient of the potential, and from the fluxes through the cell's faces,
   u = (sum_f n_f S_f^T)^-1 sum_f n_f phi_f    (n_f unit normal, S_f area vector),
the formula of OpenFOAM's fvc::reconstruct (the U that Debian's potentialFoam writes is not used).
Needs flowcage and its example programs built, and OpenFOAM (Debian: openfoam); --check fails unless the ratios hold."""
import argparse
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
RADIUS, FAR, GROWTH, NEAR = 0.5, 10.0, 1.2, 1.5  # metres; NEAR: one diameter from the wall
CORRECTORS = 10


def run(command, log, **options):
    """Runs a program with its output in `log`; ends this one with the last lines of it on failure."""
    environment = dict(os.environ)
    environment.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")
    with open(log, "w") as output:
        code = subprocess.run([str(c) for c in command], stdout=output, stderr=subprocess.STDOUT, env=environment,
                              **options).returncode
    if code != 0:
        tail = "\n".join(open(log, errors="replace").read().splitlines()[-15:])
        sys.exit(f"compare.py: {command[0]} failed (exit code {code}), see {log}:\n{tail}")


# ---------------------------------------------------------------- OpenFOAM's files


def header(name, kind):
    return f"FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"


def write(case, path, text, kind="dictionary"):
    file = case / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(header(file.name, kind) + text)


def read_list(path):
    """The entries of a field's internalField, or of a list file (owner, points), as text between brackets."""
    text = path.read_text()
    start = re.search(r"\n(\d+)\s*\n?\(", text)
    return int(start.group(1)), text[start.end(): text.index("\n)", start.end())]


def read_scalars(path):
    return [float(x) for x in read_list(path)[1].split()]


def read_vectors(path):
    numbers = [float(x) for x in read_list(path)[1].replace("(", " ").replace(")", " ").split()]
    return list(zip(numbers[0::3], numbers[1::3], numbers[2::3]))


def read_faces(path):
    """The corners of each face, as text: few of them are needed as numbers."""
    return re.findall(r"\d+\s*\(([^)]*)\)", read_list(path)[1])


def read_boundary(path):
    """{patch: (first face, number of faces)}"""
    text = path.read_text()
    return {m.group(1): (int(m.group(3)), int(m.group(2))) for m in re.finditer(
        r"(\w+)\s*\{[^}]*?nFaces\s+(\d+);[^}]*?startFace\s+(\d+);[^}]*?\}", text)}


def solver_dictionaries(case):
    write(case, "system/controlDict", """
application potentialFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1;
writeControl timeStep; writeInterval 1; writeFormat ascii; writePrecision 14; timeFormat general; timePrecision 6;
""")
    write(case, "system/fvSchemes", """
ddtSchemes { default steadyState; } gradSchemes { default leastSquares; } divSchemes { default none; div(phi,U) Gauss linear; }
laplacianSchemes { default Gauss linear corrected; } interpolationSchemes { default linear; }
snGradSchemes { default corrected; }
""")
    write(case, "system/fvSolution", f"""
solvers {{ Phi {{ solver GAMG; smoother DICGaussSeidel; tolerance 1e-10; relTol 0; }} }}
potentialFlow {{ nNonOrthogonalCorrectors {CORRECTORS}; }}
""")


# ---------------------------------------------------------------- the three meshes


def mesh_flowcage(case, settings):
    """The mesh that the example's cage gives. The other two are made to match it."""
    programs = ROOT / "build" / "release" / "bin" if settings.bin is None else settings.bin
    cad = case.parent / "sphere.step"
    run([programs / "example_01_sphere", cad], case.parent / "cad.log")
    run([programs / "flowcage", "mesh", cad, "--cage", ROOT / "examples/01_sphere/cage.obj", "--farfield", "sphere",
         "--farfield-size", FAR, "--levels", settings.levels, "--first-height", settings.first_height,
         "--growth", GROWTH, "-o", case, "--json", case.parent / "flowcage.json"], case.parent / "flowcage.log")


def expansion_ratio(length, first, count):
    """r with first (1 + r + .. + r^(count-1)) = length."""
    low, high = 1.0 + 1e-9, 3.0
    for _ in range(200):
        ratio = (low + high) / 2
        low, high = (ratio, high) if first * (ratio**count - 1) / (ratio - 1) < length else (low, ratio)
    return ratio


def mesh_blockmesh(case, settings, cells, wall_faces):
    """Six blocks between the spheres, their inner edges on the sphere: the cube's edges and faces projected."""
    around = round(math.sqrt(wall_faces / 6))
    radial = max(2, round(cells / (6 * around * around)))
    total = expansion_ratio(FAR - RADIUS, settings.first_height, radial)**(radial - 1)
    signs = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
    corners = "".join("({} {} {})\n".format(*(s * r / math.sqrt(3) for s in sign))
                      for r in (RADIUS, FAR) for sign in signs)
    sides = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (0, 4, 7, 3), (1, 2, 6, 5)]  # seen from outside
    edges = {tuple(sorted((side[i], side[i - 1]))) for side in sides for i in range(4)}
    blocks = "".join(
        f"hex ({' '.join(map(str, side))} {' '.join(str(v + 8) for v in side)}) ({around} {around} {radial})"
        f" simpleGrading (1 1 {total:.12g})\n" for side in sides)

    def projected(offset, name):
        return ("".join(f"project {a + offset} {b + offset} ({name})\n" for a, b in sorted(edges)),
                "".join(f"project ({' '.join(str(v + offset) for v in side)}) {name}\n" for side in sides),
                "".join(f"({' '.join(str(v + offset) for v in side)})\n" for side in sides))

    inner, outer = projected(0, "inner"), projected(8, "outer")
    write(case, "system/blockMeshDict", f"""
convertToMeters 1;
geometry {{ inner {{ type searchableSphere; centre (0 0 0); radius {RADIUS}; }}
           outer {{ type searchableSphere; centre (0 0 0); radius {FAR}; }} }}
vertices ( {corners} );
blocks ( {blocks} );
edges ( {inner[0]} {outer[0]} );
faces ( {inner[1]} {outer[1]} );
boundary ( sphere {{ type wall; faces ( {inner[2]} ); }} farfield {{ type patch; faces ( {outer[2]} ); }} );
""")
    run(["blockMesh", "-case", case], case / "blockMesh.log")


def mesh_snappy(case, settings, cells, wall_faces):
    """A box of the far field's half width, refined in shells round the sphere, with layers. The background's cells
    are chosen anew until the number of cells is within 4 % of the other meshes'."""
    size = math.sqrt(4 * math.pi * RADIUS**2 / wall_faces)  # of wall cells at first
    level = round(math.log2(2 * FAR / (24 * size)))  # a background of some 30 cells across
    across = 2 * FAR / (size * 2**level)
    best = None
    for _ in range(5):
        count = round(across)
        if (case / "constant").exists():
            shutil.rmtree(case / "constant")
        made = run_snappy(case, settings, count, level)
        if best is None or abs(made - cells) < abs(best[1] - cells):
            best = (count, made)
        if abs(made - cells) <= 0.04 * cells:
            break
        step = round(count * (cells / made)**(1 / 2.5))
        across = step if step != count else count + (1 if made < cells else -1)
    if best != (count, made):
        shutil.rmtree(case / "constant")
        run_snappy(case, settings, best[0], level)


def run_snappy(case, settings, across, level):
    wall_cell = 2 * FAR / across / 2**level
    layers, thickness = 0, settings.first_height
    while thickness < 0.7 * wall_cell:  # until the last layer is as thick as what follows
        layers, thickness = layers + 1, thickness * GROWTH
    # Distance from the wall to which each level reaches.
    shells = " ".join(f"({wall_cell * 6 * 2**k:.6g} {level - k})" for k in range(level))
    write(case, "system/blockMeshDict", f"""
convertToMeters 1;
vertices ( ({-FAR} {-FAR} {-FAR}) ({FAR} {-FAR} {-FAR}) ({FAR} {FAR} {-FAR}) ({-FAR} {FAR} {-FAR})
           ({-FAR} {-FAR} {FAR}) ({FAR} {-FAR} {FAR}) ({FAR} {FAR} {FAR}) ({-FAR} {FAR} {FAR}) );
blocks ( hex (0 1 2 3 4 5 6 7) ({across} {across} {across}) simpleGrading (1 1 1) );
boundary ( farfield {{ type patch; faces ( (0 3 2 1) (4 5 6 7) (0 1 5 4) (2 3 7 6) (0 4 7 3) (1 2 6 5) ); }} );
""")
    write(case, "system/snappyHexMeshDict", f"""
castellatedMesh true; snap true; addLayers true;
geometry {{ sphere {{ type searchableSphere; centre (0 0 0); radius {RADIUS}; }} }}
castellatedMeshControls
{{
  maxLocalCells 10000000; maxGlobalCells 10000000; minRefinementCells 0; nCellsBetweenLevels 4; resolveFeatureAngle 30;
  features (); refinementSurfaces {{ sphere {{ level ({level} {level}); patchInfo {{ type wall; }} }} }}
  refinementRegions {{ sphere {{ mode distance; levels ( {shells} ); }} }}
  locationInMesh (3.137 3.211 3.313); allowFreeStandingZoneFaces true;
}}
snapControls {{ nSmoothPatch 5; tolerance 2; nSolveIter 100; nRelaxIter 8; nFeatureSnapIter 0; }}
addLayersControls
{{
  relativeSizes false; layers {{ sphere {{ nSurfaceLayers {layers}; }} }}
  firstLayerThickness {settings.first_height}; expansionRatio {GROWTH}; minThickness {settings.first_height / 10};
  nGrow 0; featureAngle 180; nRelaxIter 5; nSmoothSurfaceNormals 3; nSmoothNormals 3; nSmoothThickness 10;
  maxFaceThicknessRatio 0.5; maxThicknessToMedialRatio 0.3; minMedialAxisAngle 90; nBufferCellsNoExtrude 0;
  nLayerIter 50;
}}
meshQualityControls
{{
  maxNonOrtho 65; maxBoundarySkewness 20; maxInternalSkewness 4; maxConcave 80; minVol 1e-13; minTetQuality 1e-15;
  minArea -1; minTwist 0.02; minDeterminant 0.001; minFaceWeight 0.05; minVolRatio 0.01; minTriangleTwist -1;
  nSmoothScale 4; errorReduction 0.75;
}}
mergeTolerance 1e-6;
""")
    run(["blockMesh", "-case", case], case / "blockMesh.log")
    run(["snappyHexMesh", "-overwrite", "-case", case], case / "snappyHexMesh.log")
    return max(int(x) for x in read_list(case / "constant/polyMesh/owner")[1].split()) + 1


# ---------------------------------------------------------------- the flow


def exact_potential(p):
    r2 = p[0]**2 + p[1]**2 + p[2]**2
    return p[0] * (1 + RADIUS**3 / (2 * r2**1.5))


def exact_velocity(p):
    r2 = p[0]**2 + p[1]**2 + p[2]**2
    k = RADIUS**3 / (2 * r2**1.5)
    return (1 + k - 3 * k * p[0] * p[0] / r2, -3 * k * p[0] * p[1] / r2, -3 * k * p[0] * p[2] / r2)


def face_area_and_centre(points, face):
    """Area vector and centre as OpenFOAM computes them: triangles to the mean of the corners."""
    corners = [points[int(v)] for v in face.split()]
    mid = [sum(c[a] for c in corners) / len(corners) for a in range(3)]
    area, centre, total = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.0
    for p, q in zip(corners, corners[1:] + corners[:1]):
        a, b = [p[i] - mid[i] for i in range(3)], [q[i] - mid[i] for i in range(3)]
        n = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
        size = math.sqrt(n[0]**2 + n[1]**2 + n[2]**2)
        total += size
        for i in range(3):
            area[i] += n[i] / 2
            centre[i] += size * (p[i] + q[i] + mid[i]) / 3
    return area, ([c / total for c in centre] if total > 0 else mid)


def solve3(m, b):
    """Solves a symmetric 3 x 3 system, m = (xx, xy, xz, yy, yz, zz)."""
    xx, xy, xz, yy, yz, zz = m
    c = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,
         xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy)
    det = xx * c[0] + xy * c[1] + xz * c[2]
    return ((c[0] * b[0] + c[1] * b[1] + c[2] * b[2]) / det, (c[1] * b[0] + c[3] * b[1] + c[4] * b[2]) / det,
            (c[2] * b[0] + c[4] * b[1] + c[5] * b[2]) / det)


def velocities_from_fluxes(mesh, near, flux):
    """{cell: velocity} of the cells `near`."""
    points, faces, owner, neighbour = mesh
    sums = {cell: ([0.0] * 6, [0.0] * 3) for cell in near}
    for f, cells in enumerate(zip(owner, neighbour + [None] * (len(owner) - len(neighbour)))):
        touched = [sums[cell] for cell in cells if cell in sums]
        if not touched:
            continue
        s = face_area_and_centre(points, faces[f])[0]
        size = math.sqrt(s[0]**2 + s[1]**2 + s[2]**2)
        if size == 0:
            continue
        n, phi = (s[0] / size, s[1] / size, s[2] / size), flux[f]
        for m, b in touched:
            m[0] += n[0] * s[0]
            m[1] += n[0] * s[1]
            m[2] += n[0] * s[2]
            m[3] += n[1] * s[1]
            m[4] += n[1] * s[2]
            m[5] += n[2] * s[2]
            for i in range(3):
                b[i] += n[i] * phi
    return {cell: solve3(m, b) for cell, (m, b) in sums.items()}


def solve(case):
    """Solves on the mesh in `case`; returns {quantity: value} of one row of the table."""
    solver_dictionaries(case)
    run(["foamFormatConvert", "-case", case, "-constant"], case / "foamFormatConvert.log")  # to ASCII
    mesh = case / "constant" / "polyMesh"
    points, faces = read_vectors(mesh / "points"), read_faces(mesh / "faces")
    owner = [int(x) for x in read_list(mesh / "owner")[1].split()]
    neighbour = [int(x) for x in read_list(mesh / "neighbour")[1].split()]
    patches = read_boundary(mesh / "boundary")
    outer = [name for name in patches if name.startswith("farfield")]
    walls = [name for name in patches if name not in outer and patches[name][1] > 0]

    # potentialFoam's potential is minus the usual one: its flux is -grad(Phi).
    def dirichlet(name):
        first, count = patches[name]
        values = "\n".join(repr(-exact_potential(face_area_and_centre(points, faces[f])[1])) for f in range(first, first + count))
        return f"{name} {{ type fixedValue; value nonuniform List<scalar>\n{count}\n(\n{values}\n)\n; }}\n"

    empty = [name for name in patches if name not in outer + walls]
    write(case, "0/Phi", "dimensions [0 2 -1 0 0 0 0]; internalField uniform 0;\nboundaryField {\n" +
          "".join(dirichlet(name) for name in outer) +
          "".join(f"{name} {{ type zeroGradient; }}\n" for name in walls + empty) + "}\n", "volScalarField")
    for field, kind, dimensions, zero in (("U", "volVectorField", "[0 1 -1 0 0 0 0]", "(0 0 0)"),
                                          ("p", "volScalarField", "[0 2 -2 0 0 0 0]", "0")):
        write(case, f"0/{field}", f"dimensions {dimensions}; internalField uniform {zero};\nboundaryField {{\n" +
              "".join(f"{name} {{ type fixedValue; value uniform {zero}; }}\n" for name in patches) + "}\n", kind)
    run(["potentialFoam", "-case", case, "-writePhi", "-writephi"], case / "potentialFoam.log")
    run(["postProcess", "-case", case, "-funcs", "(writeCellCentres writeCellVolumes grad(Phi))", "-time", "0"],
        case / "postProcess.log")
    run(["checkMesh", "-case", case, "-constant"], case / "checkMesh.log")

    centres, volumes = read_vectors(case / "0/C"), read_scalars(case / "0/V")
    flux = read_scalars(case / "0/phi")
    text = (case / "0/phi").read_text()
    for name, (first, count) in patches.items():  # in the order of their faces
        listed = re.search(name + r"\s*\{[^}(]*List<scalar>\s*(\d+)\s*\(([^)]*)\)", text)
        flux += [float(x) for x in listed.group(2).split()] if listed else [0.0] * count
    near = [cell for cell, p in enumerate(centres) if p[0]**2 + p[1]**2 + p[2]**2 <= NEAR**2]
    gradient = read_vectors(case / "0/grad(Phi)")
    velocity = {"gradient": {cell: tuple(-g for g in gradient[cell]) for cell in near},
                "fluxes": velocities_from_fluxes((points, faces, owner, neighbour), near, flux)}
    row = {"cells": len(centres), "wall faces": sum(patches[name][1] for name in walls)}
    check = (case / "checkMesh.log").read_text()
    row["non-orthogonality"] = float(re.search(r"non-orthogonality Max: ([\d.]+)", check).group(1))
    row["skewness"] = float(re.search(r"Max skewness = ([\d.]+)", check).group(1))
    heights = []
    for name in walls:
        first, count = patches[name]
        for f in range(first, first + count):
            s, c = face_area_and_centre(points, faces[f])
            size = math.sqrt(s[0]**2 + s[1]**2 + s[2]**2)
            heights.append(2 * abs(sum((centres[owner[f]][i] - c[i]) * s[i] for i in range(3))) / size)
    row["first height"] = sum(heights) / len(heights)
    for way, field in velocity.items():
        squares, weight, largest = 0.0, 0.0, (0.0, None)
        for cell, u in field.items():
            p, v, e = centres[cell], volumes[cell], exact_velocity(centres[cell])
            error = (u[0] - e[0])**2 + (u[1] - e[1])**2 + (u[2] - e[2])**2
            squares, weight = squares + v * error, weight + v
            largest = max(largest, (error, p))
        row[way] = (math.sqrt(squares / weight), math.sqrt(largest[0]))
        row[way + " place"] = largest[1]
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=ROOT / "build" / "04_flow_sphere")
    parser.add_argument("--levels", type=int, default=4, help="of flowcage's mesh (default: %(default)s, 69,000 cells)")
    parser.add_argument("--first-height", type=float, default=0.01, help="in diameters (default: %(default)s)")
    parser.add_argument("--bin", type=pathlib.Path, help="folder of the programs (default: build/release/bin)")
    parser.add_argument("--snappy", nargs=2, type=float, default=(0.25, 0.1), metavar=("L2", "MAX"),
                        help="largest shares of snappyHexMesh's errors that flowcage's may be (default: %(default)s)")
    parser.add_argument("--ogrid", nargs=2, type=float, default=(1.2, 1.2), metavar=("L2", "MAX"),
                        help="the same of the O-grid's (default: %(default)s)")
    parser.add_argument("--check", action="store_true", help="exit code 1 unless flowcage's errors keep these limits")
    settings = parser.parse_args()
    for program in ("blockMesh", "snappyHexMesh", "potentialFoam", "postProcess", "foamFormatConvert", "checkMesh"):
        if shutil.which(program) is None:
            print(f"compare.py: skipped, OpenFOAM's {program} is not installed (Debian: apt-get install openfoam)")
            return 77

    folder = settings.folder
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    rows = {}
    for name, make in (("flowcage", mesh_flowcage), ("snappyHexMesh", mesh_snappy), ("blockMesh", mesh_blockmesh)):
        case = folder / name
        if name == "flowcage":
            make(case, settings)
        else:
            case.mkdir()
            solver_dictionaries(case)
            make(case, settings, rows["flowcage"]["cells"], rows["flowcage"]["wall faces"])
        rows[name] = solve(case)

    kept = True
    for name, row in rows.items():
        if abs(row["first height"] / settings.first_height - 1) > 0.1:
            print(f"compare.py: {name} has a first height of {row['first height']:.4f} instead of "
                  f"{settings.first_height}: no comparison (snappyHexMesh may have left out the layers)", file=sys.stderr)
            kept = False
    print("| mesh | cells | first height | non-orthogonality | skewness | gradient: L2 | max | fluxes: L2 | max |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, row in rows.items():
        errors = " | ".join(f"{e:.5f}" for way in ("gradient", "fluxes") for e in row[way])
        print(f"| {name} | {row['cells']:,} | {row['first height']:.4f} | {row['non-orthogonality']:.1f} "
              f"| {row['skewness']:.2f} | {errors} |")
    for other, limits in (("snappyHexMesh", settings.snappy), ("blockMesh", settings.ogrid)):
        for way in ("gradient", "fluxes"):
            for error, limit, ours, theirs in zip(("L2", "max"), limits, rows["flowcage"][way], rows[other][way]):
                holds = ours <= limit * theirs
                kept = kept and holds
                print(f"flowcage / {other}, {way}, {error}: {ours / theirs:.3f} (at most {limit}) "
                      f"{'holds' if holds else 'MISSED'}")
    for name, row in rows.items():
        print(f"{name}: largest errors at ({', '.join('%.3f' % x for x in row['gradient place'])}), "
              f"({', '.join('%.3f' % x for x in row['fluxes place'])})")
    return 0 if kept or not settings.check else 1


if __name__ == "__main__":
    sys.exit(main())
