#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/curve/curved_mesh.hpp"
#include "core/curve/straighten.hpp"

namespace flowcage {
namespace {

constexpr int trace_passes = 8;    // between CAD and symmetry plane, for nodes on both
constexpr double on_chain = 1e-6;  // of the diagonal: an edge's points lie on a feature chain
constexpr std::array<double, 3> no_plane{std::numeric_limits<double>::quiet_NaN(),
                                         std::numeric_limits<double>::quiet_NaN(),
                                         std::numeric_limits<double>::quiet_NaN()};

bool lies_on_cad(PatchType type) {
  return type == PatchType::wall || type == PatchType::inlet || type == PatchType::outlet;
}

class WallCurver {
 public:
  WallCurver(const BlockMesh& mesh, const TargetSurface& target, CurvedMesh& curved)
      : mesh_(mesh),
        target_(target),
        curved_(curved),
        nodes_(curved.nodes),
        complex_(curved.nodes.complex()),
        shift_(nodes_.points().size(), Vec3::Zero()),
        on_cad_(nodes_.points().size(), 0),
        fixed_(nodes_.points().size(), 0),
        plane_(nodes_.points().size(), no_plane) {}

  /// Moves the nodes; `straight`, the nodes on the linear cells, gets the same walls.
  CurveReport run(std::vector<Vec3>& straight) {
    mark_boundary();
    project_faces();
    project_edges();
    CurveReport report;
    for (std::size_t n = 0; n < shift_.size(); ++n) {
      if (on_cad_[n] != 0) report.max_correction = std::max(report.max_correction, shift_[n].norm());
    }
    std::vector<Vec3> straight_shift(shift_.size(), Vec3::Zero());
    for (std::size_t n = 0; n < shift_.size(); ++n) {
      if (on_cad_[n] != 0) straight_shift[n] = nodes_.points()[n] + shift_[n] - straight[n];
    }
    spread(straight, straight_shift);
    spread(nodes_.mutable_points(), shift_);
    measure(report);
    return report;
  }

 private:
  template <typename Visit>
  void for_quad_nodes(Index quad, const Visit& visit) const {
    const QuadLattice at = nodes_.quad_lattice(quad);
    for (Index v = 0; v <= at.nv; ++v) {
      for (Index u = 0; u <= at.nu; ++u) visit(nodes_.point_number(at, u, v), u, v);
    }
  }

  PatchType type_of(Index quad) const { return nodes_.patches()[complex_.quad_patch[quad]].type; }
  bool is_boundary(Index quad) const { return complex_.quad_hexes[quad][1] == no_index; }
  bool is_cad(Index quad) const { return is_boundary(quad) && lies_on_cad(type_of(quad)); }
  bool is_own_point(Index u, Index v) const { return u % curved_.order == 0 && v % curved_.order == 0; }

  /// Which nodes lie on the CAD, in a symmetry plane, or are held (far field, points of the linear mesh).
  void mark_boundary() {
    for (Index quad = 0; quad < static_cast<Index>(complex_.quads.size()); ++quad) {
      if (!is_boundary(quad)) continue;
      const PatchType type = type_of(quad);
      Box3 box;
      for_quad_nodes(quad, [&](Index n, Index, Index) { box.extend(nodes_.points()[n]); });
      const double size = box.diagonal().norm();
      for_quad_nodes(quad, [&](Index n, Index u, Index v) {
        if (lies_on_cad(type)) {
          on_cad_[n] = 1;
          if (is_own_point(u, v)) fixed_[n] = 1;
        } else if (type == PatchType::symmetry) {
          for (int d = 0; d < 3; ++d) {
            if (box.sizes()[d] <= 1e-9 * size) plane_[n][d] = box.min()[d];
          }
        } else {
          fixed_[n] = 1;
        }
      });
    }
  }

  Vec3 in_plane(Index node, Vec3 p) const {
    for (int d = 0; d < 3; ++d) {
      if (!std::isnan(plane_[node][d])) p[d] = plane_[node][d];
    }
    return p;
  }

  void project_faces() {
    std::vector<Index> moved;
    std::vector<Vec3> places;
    for (Index n = 0; n < static_cast<Index>(shift_.size()); ++n) {
      if (on_cad_[n] == 0 || fixed_[n] != 0) continue;
      moved.push_back(n);
      places.push_back(nodes_.points()[n]);
    }
    std::vector<SurfacePoint> feet(places.size());
    for (int pass = 0; pass < trace_passes; ++pass) {
      target_.closest_points(places, {}, feet);
      bool again = false;
      for (std::size_t i = 0; i < moved.size(); ++i) {
        if (feet[i].status == FootStatus::failed) continue;
        places[i] = in_plane(moved[i], feet[i].position);
        again = again || places[i] != feet[i].position;
      }
      if (!again) break;
    }
    for (std::size_t i = 0; i < moved.size(); ++i) shift_[moved[i]] = places[i] - nodes_.points()[moved[i]];
  }

  /// The nodes of a block edge, by the mesh whose points they are.
  static std::vector<Index> edge_nodes(const BlockMesh& mesh, Index edge) {
    const Index n = mesh.chord_divisions()[mesh.complex().edge_chord[edge]];
    std::vector<Index> nodes{mesh.complex().edges[edge][0]};
    for (Index t = 1; t < n; ++t) nodes.push_back(mesh.edge_points(edge) + t - 1);
    nodes.push_back(mesh.complex().edges[edge][1]);
    return nodes;
  }

  /// The feature chain that runs along all points of an edge.
  std::optional<Index> chain_of(const std::vector<Index>& points) const {
    const double near = on_chain * target_.diagonal();
    for (Index chain = 0; chain < static_cast<Index>(target_.features().chains.size()); ++chain) {
      const bool along = std::ranges::all_of(points, [&](Index p) {
        return target_.closest_on_chain(chain, mesh_.points()[p]).distance <= near;
      });
      if (along) return chain;
    }
    return std::nullopt;
  }

  void project_edges() {
    for (Index edge = 0; edge < static_cast<Index>(complex_.edges.size()); ++edge) {
      const std::vector<Index> nodes = edge_nodes(nodes_, edge);
      const bool on_cad = std::ranges::all_of(nodes, [&](Index n) { return on_cad_[n] != 0; });
      if (!on_cad || !(complex_.edge_sharpness[edge] > 0)) continue;
      const std::optional<Index> chain = chain_of(edge_nodes(mesh_, edge));
      if (!chain) continue;
      for (const Index n : nodes) {
        if (fixed_[n] != 0) continue;
        const Vec3 from = nodes_.points()[n];
        shift_[n] = in_plane(n, target_.closest_on_chain(*chain, from).position) - from;
      }
    }
  }

  /// Moves the points of the CAD's nodes by `shift`; lines of nodes follow the one on the CAD that they
  /// leave.
  void spread(std::vector<Vec3>& points, const std::vector<Vec3>& shift) const {
    std::vector<Vec3> spread(shift.size(), Vec3::Zero());
    for (Index block = 0; block < nodes_.block_count(); ++block) {
      for (int face = 0; face < 6; ++face) {
        if (is_cad(complex_.hex_quads[block][face])) spread_from(block, face, points, shift, spread);
      }
    }
    for (std::size_t n = 0; n < shift.size(); ++n) {
      if (on_cad_[n] != 0) {
        points[n] += shift[n];
      } else if (fixed_[n] == 0) {
        points[n] = in_plane(static_cast<Index>(n), points[n] + spread[n]);
      }
    }
  }

  void spread_from(Index block, int face, const std::vector<Vec3>& points, const std::vector<Vec3>& shift,
                   std::vector<Vec3>& spread) const {
    const auto dims = nodes_.dims(block);
    const int d = face / 2, a = (d + 1) % 3, b = (d + 2) % 3;
    std::vector<Index> line(static_cast<std::size_t>(dims[d]) + 1);
    std::vector<double> length(line.size());
    std::array<Index, 3> x{};
    for (x[b] = 0; x[b] <= dims[b]; ++x[b]) {
      for (x[a] = 0; x[a] <= dims[a]; ++x[a]) {
        for (Index k = 0; k <= dims[d]; ++k) {
          x[d] = face % 2 == 0 ? k : dims[d] - k;
          line[k] = nodes_.point_number(block, x[0], x[1], x[2]);
          length[k] = k == 0 ? 0 : length[k - 1] + (points[line[k]] - points[line[k - 1]]).norm();
        }
        const Vec3& from = shift[line[0]];
        for (std::size_t k = 1; k < line.size() && length.back() > 0; ++k) {
          const Vec3 share = (1 - length[k] / length.back()) * from;
          if (share.squaredNorm() > spread[line[k]].squaredNorm()) spread[line[k]] = share;
        }
      }
    }
  }

  void measure(CurveReport& report) const {
    std::vector<Vec3> places;
    for (std::size_t n = 0; n < shift_.size(); ++n) {
      if (on_cad_[n] != 0) places.push_back(nodes_.points()[n]);
    }
    std::vector<SurfacePoint> feet(places.size());
    target_.closest_points(places, {}, feet);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      if (!(feet[i].distance > report.max_wall_distance)) continue;
      report.max_wall_distance = feet[i].distance;
      report.worst_place = places[i];
    }
  }

  const BlockMesh& mesh_;
  const TargetSurface& target_;
  CurvedMesh& curved_;
  BlockMesh& nodes_;
  const HexComplex& complex_;
  std::vector<Vec3> shift_;
  std::vector<char> on_cad_, fixed_;
  std::vector<std::array<double, 3>> plane_;  ///< coordinates that a symmetry plane holds; NaN: free
};

}  // namespace

CurvedMesh make_curved_mesh(const BlockMesh& mesh, const TargetSurface& target, int order,
                            CurveReport& report, Progress& progress) {
  progress.step("curve", 0);
  CurvedMesh curved = interpolated_mesh(mesh, order);
  progress.step("curve", 0.3);
  const CurvedMesh linear = interpolated_mesh(mesh, order, false);
  std::vector<Vec3> straight(linear.nodes.points().begin(), linear.nodes.points().end());
  report = WallCurver(mesh, target, curved).run(straight);
  progress.step("curve", 0.6);
  report.straightened = straighten_cells(curved, straight);
  return curved;
}

}  // namespace flowcage
