'use strict';
// A scene (cli/report/scene.hpp) as it is embedded in the page: numbers decoded, coloured, made triangles.

function decodeNumbers(text, Type) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Type(bytes.buffer);
}

function decodeSurface(surface) {
  return {
    names: surface.names,
    points: decodeNumbers(surface.points, Float32Array),
    faces: decodeNumbers(surface.faces, Int32Array),
    name: decodeNumbers(surface.name, Int32Array),
    region: decodeNumbers(surface.region, Int32Array),
    block: decodeNumbers(surface.block, Int32Array),
    quality: decodeNumbers(surface.quality, Float32Array),
    deviation: decodeNumbers(surface.deviation, Float32Array),
  };
}

// Colours by value, as cli/report/color_map.cpp has them; stops, scales and the colours of blocks come with the scene.
class Colours {
  constructor(colors) {
    this.colors = colors;
  }
  verdict(scale, value) {
    const { bad, good, logarithmic } = scale;
    let t;
    if (logarithmic) t = value > 0 ? Math.log(value / bad) / Math.log(good / bad) : 1;
    else t = (value - bad) / (good - bad);
    if (!(t >= 0) || (t === 0 && !logarithmic)) return this.colors.failure;
    const stops = this.colors.stops;
    const at = Math.min(t, 1) * (stops.length - 1);
    const low = Math.min(Math.floor(at), stops.length - 2);
    return [0, 1, 2].map((c) => stops[low][c] + (at - low) * (stops[low + 1][c] - stops[low][c]));
  }
  block(number) {
    return this.colors.blocks[number % this.colors.blocks.length];
  }
  // Of face f of a surface at its corner's point.
  of(surface, mode, f, point) {
    if (mode === 'deviation' && surface.deviation.length) {
      return this.verdict(this.colors.deviation, surface.deviation[point]);
    }
    if (mode === 'quality' && surface.quality.length) return this.verdict(this.colors.quality, surface.quality[f]);
    if (mode === 'block' && surface.block.length) return this.block(surface.block[f]);
    if (mode === 'patch') return surface.names[surface.name[f]].color;
    return this.colors.neutral;
  }
}

// Triangles with a colour a corner and a source (a face or cell) each.
class TriangleList {
  constructor() {
    this.positions = [];
    this.colors = [];
    this.source = [];
  }
  // A polygon: a quad is cut along its shorter diagonal, a larger one from its first corner.
  face(points, colors, source) {
    const far = (a, b) => Math.hypot(...[0, 1, 2].map((x) => points[a][x] - points[b][x]));
    let triangles = points.slice(2).map((_, c) => [0, c + 1, c + 2]);
    if (points.length === 4) triangles = far(0, 2) <= far(1, 3) ? [[0, 1, 2], [0, 2, 3]] : [[1, 2, 3], [1, 3, 0]];
    for (const triangle of triangles) {
      for (const c of triangle) {
        this.positions.push(points[c][0], points[c][1], points[c][2]);
        this.colors.push(255 * colors[c][0], 255 * colors[c][1], 255 * colors[c][2]);
      }
      this.source.push(source);
    }
  }
  geometry() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(this.positions), 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(this.colors), 3, true));
    return geometry;
  }
}

function segmentGeometry(positions) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
  return geometry;
}

const pointOf = (points, p) => [points[3 * p], points[3 * p + 1], points[3 * p + 2]];

// The cells of a block mesh and those of them that a plane cuts.
class Volume {
  constructor(volume) {
    this.points = decodeNumbers(volume.points, Float32Array);
    this.dims = decodeNumbers(volume.dims, Int32Array);
    this.numbers = decodeNumbers(volume.numbers, Int32Array);
    this.quality = decodeNumbers(volume.quality, Float32Array);
    this.bounds = [[Infinity, -Infinity], [Infinity, -Infinity], [Infinity, -Infinity]];
    for (let i = 0; i < this.points.length; ++i) {
      const range = this.bounds[i % 3];
      range[0] = Math.min(range[0], this.points[i]);
      range[1] = Math.max(range[1], this.points[i]);
    }
  }
  // visit(block, cell, corners, neighbourCut) for each cell that the plane cuts: corners are point numbers in VTK order;
  // neighbourCut(face) says whether the cell behind that face of the same block is cut, too.
  visitCut(axis, value, visit) {
    const faceStep = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
    let firstNumber = 0;
    let firstCell = 0;
    for (let block = 0; 3 * block < this.dims.length; ++block) {
      const [ni, nj, nk] = this.dims.subarray(3 * block, 3 * block + 3);
      const at = (i, j, k) => this.numbers[firstNumber + i + (ni + 1) * (j + (nj + 1) * k)];
      const above = (i, j, k) => this.points[3 * at(i, j, k) + axis] > value;
      const isCut = (i, j, k) => {
        if (i < 0 || j < 0 || k < 0 || i >= ni || j >= nj || k >= nk) return false;
        const first = above(i, j, k);
        for (let c = 1; c < 8; ++c) {
          if (above(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) !== first) return true;
        }
        return false;
      };
      for (let k = 0; k < nk; ++k) {
        for (let j = 0; j < nj; ++j) {
          for (let i = 0; i < ni; ++i) {
            if (!isCut(i, j, k)) continue;
            const corners = [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
              at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)];
            visit(block, firstCell + i + ni * (j + nj * k), corners, (face) => {
              const [di, dj, dk] = faceStep[face];
              return isCut(i + di, j + dj, k + dk);
            });
          }
        }
      }
      firstNumber += (ni + 1) * (nj + 1) * (nk + 1);
      firstCell += ni * nj * nk;
    }
  }
}

const hexFaces = [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];
const hexEdges = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

// Where a plane cuts a cell of these corners: a polygon, in order round its middle.
function cutPolygon(corners, axis, value) {
  const polygon = [];
  for (const [a, b] of hexEdges) {
    const [p, q] = [corners[a], corners[b]];
    if ((p[axis] > value) === (q[axis] > value)) continue;
    const t = (value - p[axis]) / (q[axis] - p[axis]);
    polygon.push([0, 1, 2].map((x) => (x === axis ? value : p[x] + t * (q[x] - p[x]))));
  }
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
  const middle = (x) => polygon.reduce((sum, point) => sum + point[x], 0) / polygon.length;
  const [mu, mv] = [middle(u), middle(v)];
  const angle = (point) => Math.atan2(point[v] - mv, point[u] - mu);
  return polygon.map((point) => [angle(point), point]).sort((a, b) => a[0] - b[0]).map(([, point]) => point);
}
