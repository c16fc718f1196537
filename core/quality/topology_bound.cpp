#include "core/quality/topology_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.hpp"
#include "core/mesh/hex_numbering.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/volume/corner_fan.hpp"

namespace flowcage {
namespace {

/// One corner of a boundary quad at a point.
struct Corner {
  Index point = no_index;
  Offset cell = 0;  ///< the quad's
  bool symmetry = false;
  FanCorner fan;
};

/// Corners of all boundary quads, by point.
struct Corners {
  std::vector<Corner> all;
  std::vector<Offset> begin;  ///< of each point's, in `all`; one more at the end
};

Corners corners_by_point(const HexView& mesh) {
  Corners out;
  for (const BoundaryPatch& patch : mesh.patches()) {
    for (std::size_t q = 0; q < patch.quads.size(); ++q) {
      const auto& quad = patch.quads[q];
      for (int c = 0; c < 4; ++c) {
        // Quads are counter-clockwise from outside of the fluid.
        out.all.push_back({quad[c], patch.owner[q], patch.type == PatchType::symmetry,
                           fan_corner(mesh.points(), quad[c], quad[(c + 3) % 4], quad[(c + 1) % 4])});
      }
    }
  }
  std::stable_sort(out.all.begin(), out.all.end(),
                   [](const Corner& a, const Corner& b) { return a.point < b.point; });
  for (std::size_t n = 0; n < out.all.size(); ++n) {
    if (n == 0 || out.all[n].point != out.all[n - 1].point) out.begin.push_back(static_cast<Offset>(n));
  }
  out.begin.push_back(static_cast<Offset>(out.all.size()));
  return out;
}

/// The bound at a point from its corners; 1 where no line is free.
double point_bound(std::span<const Corner> corners, double crease_degrees) {
  std::vector<FanCorner> own;
  Vec3 mirror = Vec3::Zero();
  for (const Corner& corner : corners) {
    if (corner.symmetry) {
      mirror = corner.fan.normal;
      continue;
    }
    const auto quads_of_cell = std::count_if(corners.begin(), corners.end(), [&](const Corner& other) {
      return other.cell == corner.cell && !other.symmetry;
    });
    if (quads_of_cell == 1) own.push_back(corner.fan);
  }
  if (own.empty()) return 1;
  const std::vector<double> sines = best_sines(own, crease_degrees);
  std::vector<Vec3> hull;
  for (std::size_t i = 0; i < own.size(); ++i) {
    hull.push_back(sines[i] * (own[i].normal - mirror * mirror.dot(own[i].normal)));
  }
  return std::min(1.0, nearest_in_hull(hull).norm());
}

/// Lowers the values of points on the blocks' inner edges where not four hexes meet.
void bound_inner_edges(const BlockMesh& mesh, std::vector<float>& values) {
  const HexComplex& complex = mesh.complex();
  std::vector<int> hexes(complex.edges.size(), 0);
  std::vector<char> boundary(complex.edges.size(), 0);
  for (std::size_t h = 0; h < complex.hexes.size(); ++h) {
    for (const Index e : complex.hex_edges[h]) ++hexes[e];
    for (int f = 0; f < 6; ++f) {
      if (complex.quad_hexes[complex.hex_quads[h][f]][1] != no_index) continue;
      for (int e = 0; e < 12; ++e) {
        const auto on_face = [&](int corner) {
          return std::find(hex_faces[f].begin(), hex_faces[f].end(), corner) != hex_faces[f].end();
        };
        if (on_face(hex_edges[e][0]) && on_face(hex_edges[e][1])) boundary[complex.hex_edges[h][e]] = 1;
      }
    }
  }
  for (std::size_t e = 0; e < hexes.size(); ++e) {
    if (boundary[e] != 0 || hexes[e] == 4 || hexes[e] < 3) continue;
    const auto bound = static_cast<float>(std::sin(2 * std::numbers::pi / hexes[e]));
    const auto lower = [&](Index p) { values[p] = std::min(values[p], bound); };
    lower(complex.edges[e][0]);
    lower(complex.edges[e][1]);
    const Index inside = mesh.chord_divisions()[complex.edge_chord[e]] - 1;
    for (Index t = 0; t < inside; ++t) lower(mesh.edge_points(static_cast<Index>(e)) + t);
  }
}

}  // namespace

TopologyBound topology_bound(const BlockMesh& mesh, double crease_degrees) {
  TopologyBound out;
  out.points.assign(mesh.points().size(), 1);
  const Corners corners = corners_by_point(mesh);
  parallel_for(static_cast<Offset>(corners.begin.size()) - 1, 256, [&](Offset begin, Offset end) {
    for (Offset n = begin; n < end; ++n) {
      const Offset first = corners.begin[n];
      const std::span<const Corner> own(corners.all.data() + first,
                                        static_cast<std::size_t>(corners.begin[n + 1] - first));
      out.points[own[0].point] = static_cast<float>(point_bound(own, crease_degrees));
    }
  });
  bound_inner_edges(mesh, out.points);
  const auto least = std::min_element(out.points.begin(), out.points.end());
  if (least == out.points.end()) return out;
  out.min = static_cast<double>(*least);
  out.place = mesh.points()[least - out.points.begin()];
  return out;
}

}  // namespace flowcage
