#include "core/curve/curved_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flowcage {
namespace {

using Ijk = std::array<Index, 3>;

/// Points of a box, i fastest.
struct Lattice {
  Ijk size{};
  std::vector<Vec3> points;
  std::size_t at(const Ijk& x) const {
    return static_cast<std::size_t>(x[0]) +
           static_cast<std::size_t>(size[0]) *
               (static_cast<std::size_t>(x[1]) +
                static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(x[2]));
  }
};

/// A slope no longer than three times the shorter segment beside it: the curve does not turn back.
Vec3 limited(const Vec3& slope, double before, double after) {
  const double most = 3 * std::min(before, after), length = slope.norm();
  return length <= most ? slope : Vec3(slope * (most / length));
}

/// A polyline with `order` - 1 points more in each segment, on its cubic Hermite curve or (not `smooth`) on
/// the segment itself.
std::vector<Vec3> refined_line(const std::vector<Vec3>& p, int order, bool smooth) {
  const std::size_t segments = p.size() - 1;
  const auto length = [&](std::size_t s) { return (p[s + 1] - p[s]).norm(); };
  std::vector<Vec3> slope(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!smooth) continue;
    if (segments == 1) {
      slope[i] = p[1] - p[0];
    } else if (i == 0) {
      slope[i] = limited((-3 * p[0] + 4 * p[1] - p[2]) / 2, length(0), length(0));
    } else if (i == segments) {
      slope[i] = limited((3 * p[i] - 4 * p[i - 1] + p[i - 2]) / 2, length(i - 1), length(i - 1));
    } else {
      slope[i] = limited((p[i + 1] - p[i - 1]) / 2, length(i - 1), length(i));
    }
  }
  std::vector<Vec3> fine;
  fine.reserve(segments * static_cast<std::size_t>(order) + 1);
  for (std::size_t s = 0; s < segments; ++s) {
    fine.push_back(p[s]);
    for (int a = 1; a < order; ++a) {
      const double t = static_cast<double>(a) / order, u = 1 - t;
      if (!smooth) {
        fine.push_back(u * p[s] + t * p[s + 1]);
        continue;
      }
      fine.push_back(u * u * (1 + 2 * t) * p[s] + t * t * (3 - 2 * t) * p[s + 1] + t * u * u * slope[s] -
                     t * t * u * slope[s + 1]);
    }
  }
  fine.push_back(p.back());
  return fine;
}

Lattice refined_along(const Lattice& coarse, int d, int order, bool smooth) {
  Lattice fine;
  fine.size = coarse.size;
  fine.size[d] = (coarse.size[d] - 1) * order + 1;
  fine.points.resize(static_cast<std::size_t>(fine.size[0]) * static_cast<std::size_t>(fine.size[1]) *
                     static_cast<std::size_t>(fine.size[2]));
  const int a = (d + 1) % 3, b = (d + 2) % 3;
  std::vector<Vec3> line(static_cast<std::size_t>(coarse.size[d]));
  Ijk x{};
  for (x[b] = 0; x[b] < coarse.size[b]; ++x[b]) {
    for (x[a] = 0; x[a] < coarse.size[a]; ++x[a]) {
      for (x[d] = 0; x[d] < coarse.size[d]; ++x[d])
        line[static_cast<std::size_t>(x[d])] = coarse.points[coarse.at(x)];
      const std::vector<Vec3> points = refined_line(line, order, smooth);
      for (x[d] = 0; x[d] < fine.size[d]; ++x[d])
        fine.points[fine.at(x)] = points[static_cast<std::size_t>(x[d])];
    }
  }
  return fine;
}

}  // namespace

CurvedMesh interpolated_mesh(const BlockMesh& mesh, int order, bool smooth) {
  std::vector<Index> divisions = mesh.chord_divisions();
  for (Index& n : divisions) n *= order;
  const Index count = BlockMesh::point_count(mesh.complex(), divisions);
  CurvedMesh curved{order, BlockMesh(mesh.shared_complex(), std::move(divisions),
                                     std::vector<Vec3>(static_cast<std::size_t>(count)))};
  std::vector<char> placed(static_cast<std::size_t>(count), 0);
  for (Index block = 0; block < mesh.block_count(); ++block) {
    const auto dims = mesh.dims(block);
    Lattice lattice;
    lattice.size = {dims[0] + 1, dims[1] + 1, dims[2] + 1};
    Ijk x{};
    for (x[2] = 0; x[2] <= dims[2]; ++x[2]) {
      for (x[1] = 0; x[1] <= dims[1]; ++x[1]) {
        for (x[0] = 0; x[0] <= dims[0]; ++x[0]) {
          lattice.points.push_back(mesh.points()[mesh.point_number(block, x[0], x[1], x[2])]);
        }
      }
    }
    for (int d = 0; d < 3; ++d) lattice = refined_along(lattice, d, order, smooth);
    std::size_t next = 0;
    for (x[2] = 0; x[2] < lattice.size[2]; ++x[2]) {
      for (x[1] = 0; x[1] < lattice.size[1]; ++x[1]) {
        for (x[0] = 0; x[0] < lattice.size[0]; ++x[0], ++next) {
          // A node that blocks share is that of the first of them.
          const Index node = curved.nodes.point_number(block, x[0], x[1], x[2]);
          if (std::exchange(placed[node], 1) == 0) curved.nodes.mutable_points()[node] = lattice.points[next];
        }
      }
    }
  }
  return curved;
}

void CurvedMesh::read_cell(Offset cell, std::span<Index> out) const {
  const Index block = nodes.block_of(cell * order * order * order);
  const auto fine = nodes.dims(block);
  const Ijk dims{fine[0] / order, fine[1] / order, fine[2] / order};
  const Offset inside = cell - nodes.block_begin(block) / (order * order * order);
  const Ijk first{static_cast<Index>(inside % dims[0]) * order,
                  static_cast<Index>(inside / dims[0] % dims[1]) * order,
                  static_cast<Index>(inside / dims[0] / dims[1]) * order};
  std::size_t next = 0;
  for (Index k = 0; k <= order; ++k) {
    for (Index j = 0; j <= order; ++j) {
      for (Index i = 0; i <= order; ++i) {
        out[next++] = nodes.point_number(block, first[0] + i, first[1] + j, first[2] + k);
      }
    }
  }
}

std::vector<Index> CurvedMesh::patch_quads(std::size_t patch) const {
  const HexComplex& complex = nodes.complex();
  std::vector<Index> out;
  for (Index quad = 0; quad < static_cast<Index>(complex.quads.size()); ++quad) {
    if (complex.quad_patch[quad] != static_cast<Index>(patch)) continue;
    const QuadLattice at = nodes.quad_lattice(quad);
    for (Index v = 0; v < at.nv; v += order) {
      for (Index u = 0; u < at.nu; u += order) {
        for (Index b = 0; b <= order; ++b) {
          for (Index a = 0; a <= order; ++a) out.push_back(nodes.point_number(at, u + a, v + b));
        }
      }
    }
  }
  return out;
}

}  // namespace flowcage
