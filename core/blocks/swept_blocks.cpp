#include "core/blocks/swept_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.hpp"
#include "core/mesh/hex_numbering.hpp"
#include "core/subdivide/refine.hpp"

namespace flowcage {
namespace {

/// The far-field box in the box's axes: u, s, w.
struct FarBox {
  SweptAxes axes;
  Vec3 low, high;

  Vec3 place(double u, double s, double w) const {  // -1 .. 1 across each pair of sides
    // Exactly on its sides.
    const auto at = [&](int a, double t) {
      return t == -1 ? low[a] : t == 1 ? high[a] : (low[a] + high[a]) / 2 + t * (high[a] - low[a]) / 2;
    };
    return axes.place(at(0, u), at(1, s), at(2, w));
  }
};

/// Coordinate axes nearest to the body's where the span is one.
SweptAxes box_axes(const SweptAxes& body) {
  SweptAxes axes = body;
  if (body.span.cwiseAbs().maxCoeff() < 1) return axes;
  Index a = 0;
  body.chord.cwiseAbs().maxCoeff(&a);
  axes.chord = body.chord[a] > 0 ? Vec3(Vec3::Unit(a)) : Vec3(-Vec3::Unit(a));
  axes.normal = axes.chord.cross(axes.span);
  return axes;
}

/// Where the plan's outer vertices lie on the box and its plug in the far planes, parts of half the box.
class OuterLayout {
 public:
  explicit OuterLayout(const SweptPlan& plan) : plan_(plan), at_(plan.count, Vec2::Zero()) {
    constexpr double over_trailing = 0.3, over_rear = -0.35;
    const std::vector<Vec2> coarse{{over_trailing, 1}, {over_rear, 1},     {-1, 1}, {-1, 0}, {-1, -1},
                                   {over_rear, -1},    {over_trailing, -1}};
    for (std::size_t n = 0; n < plan.side.size(); ++n) {
      at_[plan.side[n]] = n % 2 == 0 ? coarse[n / 2] : Vec2((coarse[n / 2] + coarse[n / 2 + 1]) / 2);
    }
    at_[plan.back_upper] = {1, 1};
    at_[plan.back_lower] = {1, -1};
    const bool blunt = plan.trailing == TrailingEdge::blunt;
    constexpr double half_wake = 0.3;
    for (std::size_t n = 0; n < plan.wake.size(); ++n) {
      at_[plan.wake[n]] = {1, blunt ? half_wake * (1 - static_cast<double>(n) / 2) : 0};
    }
    const double base = blunt ? 0.15 : 0;
    const std::vector<Vec2> ring{{0.35, base},  {0.05, 0.33},  {-0.3, 0.28},  {-0.45, 0},
                                 {-0.3, -0.28}, {0.05, -0.33}, {0.35, -base}, {0.35, 0}};
    for (Index v = 0; v < plan.ring; ++v) at_[v] = ring[v];
    at_[plan.front] = {-0.22, 0};
    at_[plan.rear] = {0.05, 0};
    for (const auto& [edge, middle] : plan.middle) at_[middle] = (at_[edge[0]] + at_[edge[1]]) / 2;
    for (std::size_t f = 0; f < plan.plug.size(); ++f) {
      Vec2 sum = Vec2::Zero();
      for (const Index v : plan.plug[f]) sum += at_[v];
      at_[plan.centre[f]] = sum / static_cast<double>(plan.plug[f].size());
    }
  }
  const Vec2& operator[](Index vertex) const { return at_[vertex]; }

 private:
  const SweptPlan& plan_;
  std::vector<Vec2> at_;
};

/// Sweeps the plan. Levels along the span: (far plane), 2 a section - 1 of the fine wall, (far plane).
class Sweep {
 public:
  Sweep(SweptBlocks& out, const SweptCage& cage, const FarBox& box)
      : out_(out), plan_(out.plan), cage_(cage), box_(box), layout_(plan_) {
    first_ = out.body.ends[0] == SweptEnd::open ? 0 : 1;
    last_ = first_ + 2 * static_cast<Index>(out.body.sections.size()) - 2;
    levels_ = last_ + 1 + (out.body.ends[1] == SweptEnd::open ? 0 : 1);
  }

  /// Complex, wall and seats.
  void make(const std::string& source) {
    const SurfaceLevel coarse = build_surface_level(out_.cage);
    const std::vector<Vec3> wall_points = apply_stencils(refinement_stencils(coarse), out_.cage.points);
    const SurfaceLevel wall = build_child_level(coarse);
    const std::vector<Index> corner = wall_corners(coarse, wall);
    hexes();
    boundary(corner, wall);
    place_points(corner, wall_points);
    std::vector<HexComplex::Patch> patches{{"wall", PatchType::wall}, {"farfield", PatchType::farfield}};
    if (first_ == 0) patches.push_back({"symmetry", PatchType::symmetry});
    HexComplex complex =
        build_hex_complex(std::move(points_), std::move(hexes_), std::move(patches), boundary_, box_edges());
    sharpen(complex, corner, wall);
    seat(std::make_shared<const HexComplex>(std::move(complex)), corner, wall, source);
  }

 private:
  bool has_body(Index layer) const { return layer >= first_ && layer < last_; }

  Index corner(Index level, Index vertex) {
    const auto [found, fresh] = number_.try_emplace({level, vertex}, static_cast<Index>(points_.size()));
    if (fresh) {
      points_.push_back(outer_place(level, vertex));
      std::uint8_t outward = level < first_ || level > last_ ? 4 : 0;
      if (vertex >= plan_.side.front()) outward |= bits(vertex);
      out_.outward.push_back(outward);
      out_.corners.push_back({level, vertex});
    }
    return found->second;
  }

  std::uint8_t bits(Index vertex) const {
    if (vertex == plan_.back_upper || vertex == plan_.back_lower) return 3;
    return vertex <= plan_.side.back() ? 1 : 2;
  }

  /// Places on the box; in far planes the plug, too. Inboard vertices of the wall come later.
  Vec3 outer_place(Index level, Index vertex) const {
    const double span_end = first_ == 0 ? 0 : -fan;
    const double t = static_cast<double>(level - first_) / (last_ - first_);
    double s = span_end + t * (fan - span_end);
    if (first_ == 0) s = 2 * s - 1;  // the box begins at the symmetry plane
    if (level < first_) s = -1;
    if (level > last_) s = 1;
    return box_.place(layout_[vertex].x(), s, layout_[vertex].y());
  }

  /// The corner of each vertex of the cage's level 1.
  std::vector<Index> wall_corners(const SurfaceLevel& coarse, const SurfaceLevel& wall) {
    const auto fine = [&](Index v) { return first_ + 2 * cage_.places[v].section; };
    std::vector<Index> out;
    for (Index v = 0; v < coarse.vertex_count(); ++v) out.push_back(corner(fine(v), cage_.places[v].vertex));
    for (const auto& [a, b] : coarse.edge_vertices) {
      const Index va = cage_.places[a].vertex;
      const Index vb = cage_.places[b].vertex;
      out.push_back(corner((fine(a) + fine(b)) / 2, va == vb ? va : plan_.middle_of(va, vb)));
    }
    std::map<std::vector<Index>, Index> centre;
    for (std::size_t f = 0; f < plan_.plug.size(); ++f) {
      std::vector<Index> polygon = plan_.plug[f];
      std::sort(polygon.begin(), polygon.end());
      centre[polygon] = plan_.centre[f];
    }
    for (Index f = 0; f < coarse.face_count(); ++f) {
      const auto v = coarse.face_vertices[f];
      std::vector<Index> in_plan;
      Index low = fine(v[0]);
      Index high = low;
      for (const Index n : v) {
        in_plan.push_back(cage_.places[n].vertex);
        low = std::min(low, fine(n));
        high = std::max(high, fine(n));
      }
      std::sort(in_plan.begin(), in_plan.end());
      if (low == high) {
        out.push_back(corner(low, centre.at(in_plan)));
      } else {
        out.push_back(corner((low + high) / 2, plan_.middle_of(in_plan.front(), in_plan.back())));
      }
    }
    if (static_cast<Index>(out.size()) != wall.vertex_count()) {
      throw Error(ErrorKind::internal, "swept blocks: the wall's numbering is not the cage's",
                  "report this defect");
    }
    return out;
  }

  void hexes() {
    for (Index layer = 0; layer + 1 < levels_; ++layer) {
      const auto add = [&](const auto& q) {
        HexPoints hex{};
        constexpr std::array<int, 4> turned{0, 3, 2, 1};  // the plan is seen against the span
        for (int n = 0; n < 4; ++n) {
          hex[n] = corner(layer, q[turned[n]]);
          hex[n + 4] = corner(layer + 1, q[turned[n]]);
        }
        hexes_.push_back(hex);
      };
      for (const auto& q : plan_.outside) add(q);
      if (has_body(layer)) continue;
      for (const auto& q : plan_.fine_plug) add(q);
    }
  }

  void boundary(std::span<const Index> corner_of, const SurfaceLevel& wall) {
    for (Index f = 0; f < wall.face_count(); ++f) {
      const auto v = wall.face_vertices[f];
      boundary_.push_back({{corner_of[v[0]], corner_of[v[1]], corner_of[v[2]], corner_of[v[3]]}, 0});
    }
    for (Index layer = 0; layer + 1 < levels_; ++layer) {
      for (const auto& [a, b] : plan_.outer) {
        boundary_.push_back(
            {{corner(layer, a), corner(layer, b), corner(layer + 1, b), corner(layer + 1, a)}, 1});
      }
    }
    const auto plane = [&](Index level, Index patch, bool with_plug) {
      const auto add = [&](const auto& q) {
        boundary_.push_back(
            {{corner(level, q[0]), corner(level, q[1]), corner(level, q[2]), corner(level, q[3])}, patch});
      };
      for (const auto& q : plan_.outside) add(q);
      if (!with_plug) return;
      for (const auto& q : plan_.fine_plug) add(q);
    };
    plane(0, first_ == 0 ? 2 : 1, first_ != 0);
    plane(levels_ - 1, 1, true);
  }

  /// Wall points; those of the plug between the wall's ends and the far planes are where the wall is.
  void place_points(std::span<const Index> corner_of, std::span<const Vec3> wall_points) {
    for (std::size_t v = 0; v < corner_of.size(); ++v) points_[corner_of[v]] = wall_points[v];
    if (first_ != 0) return;
    SymmetryPlane plane;
    plane.normal = out_.body.axes.span;
    plane.offset = plane.normal.dot(box_.place(0, -1, 0));
    for (int a = 0; a < 3; ++a) {
      if (std::abs(plane.normal[a]) == 1) plane.axis = a;
    }
    for (const auto& [at, number] : number_) {
      if (at.first == 0) plane.flatten(points_[number]);
    }
    symmetry_ = plane;
  }

  std::vector<SharpEdge> box_edges() {
    std::vector<SharpEdge> sharp;
    const std::array<Index, 4> along{plan_.side[4], plan_.side[8], plan_.back_upper, plan_.back_lower};
    for (Index layer = 0; layer + 1 < levels_; ++layer) {
      for (const Index v : along) sharp.push_back({corner(layer, v), corner(layer + 1, v)});
    }
    for (const Index level : {Index{0}, levels_ - 1}) {
      for (const auto& [a, b] : plan_.outer) sharp.push_back({corner(level, a), corner(level, b)});
    }
    return sharp;
  }

  /// The wall's creases and corners, not those that the complex would make where it is cut.
  static void sharpen(HexComplex& complex, std::span<const Index> corner_of, const SurfaceLevel& wall) {
    std::map<std::array<Index, 2>, Index> edge_of;
    for (std::size_t e = 0; e < complex.edges.size(); ++e) {
      const auto [low, high] = std::minmax(complex.edges[e][0], complex.edges[e][1]);
      edge_of[{low, high}] = static_cast<Index>(e);
    }
    for (Index e = 0; e < wall.edge_count(); ++e) {
      const auto [low, high] =
          std::minmax(corner_of[wall.edge_vertices[e][0]], corner_of[wall.edge_vertices[e][1]]);
      complex.edge_sharpness[edge_of.at({low, high})] = wall.edge_sharpness[e];
    }
    for (Index v = 0; v < wall.vertex_count(); ++v) {
      complex.corner_sharpness[corner_of[v]] = wall.vertex_sharpness[v];
    }
  }

  /// Cuts the wall where its blocks have several lines at a vertex, and seats the blocks.
  void seat(std::shared_ptr<const HexComplex> complex, std::span<const Index> corner_of,
            const SurfaceLevel& wall, const std::string& source) {
    std::map<std::array<Index, 4>, Index> block_on;
    for (std::size_t q = 0; q < complex->quads.size(); ++q) {
      if (complex->quad_patch[q] != 0) continue;
      std::array<Index, 4> corners = complex->quads[q];
      std::sort(corners.begin(), corners.end());
      block_on[corners] = complex->quad_hexes[q][0];
    }
    std::map<std::array<Index, 2>, Index> line;  // (vertex, the line's other end): vertex of the cut wall
    Cage cut;
    cut.patch_names = {""};
    std::vector<Index> cut_corner;
    for (Index f = 0; f < wall.face_count(); ++f) {
      const auto v = wall.face_vertices[f];
      std::array<Index, 4> corners{};
      for (int n = 0; n < 4; ++n) corners[n] = corner_of[v[n]];
      std::array<Index, 4> sorted = corners;
      std::sort(sorted.begin(), sorted.end());
      const HexPoints& hex = complex->hexes[block_on.at(sorted)];
      std::array<Index, 4> row{};
      for (int n = 0; n < 4; ++n) {
        const Index head = line_end(hex, sorted, corners[n]);
        const auto [found, fresh] = line.try_emplace({v[n], head}, static_cast<Index>(cut_corner.size()));
        if (fresh) {
          cut_corner.push_back(corners[n]);
          out_.cage_vertex.push_back(v[n]);
          // Places play no part, and those of lines from one vertex are no duplicates.
          cut.points.emplace_back(found->second, 0, 0);
        }
        row[n] = found->second;
      }
      cut.faces.push_row(row);
      cut.face_patch.push_back(0);
    }
    out_.blocks = seat_blocks(std::move(complex), build_surface_level(cut), cut_corner, source);
    out_.blocks.symmetry = symmetry_;
  }

  /// The neighbour of `foot` in the hex that is not on the wall's face.
  static Index line_end(const HexPoints& hex, const std::array<Index, 4>& sorted_face, Index foot) {
    for (const auto& [a, b] : hex_edges) {
      if (hex[a] != foot && hex[b] != foot) continue;
      const Index other = hex[a] == foot ? hex[b] : hex[a];
      if (!std::binary_search(sorted_face.begin(), sorted_face.end(), other)) return other;
    }
    return no_index;
  }

  static constexpr double fan = 0.5;  // how far out on the box's sides the lines of the tip end
  SweptBlocks& out_;
  const SweptPlan& plan_;
  const SweptCage& cage_;
  const FarBox& box_;
  OuterLayout layout_;
  Index first_ = 0, last_ = 0, levels_ = 0;
  std::map<std::pair<Index, Index>, Index> number_;
  std::vector<Vec3> points_;
  std::vector<HexPoints> hexes_;
  std::vector<BoundaryQuad> boundary_;
  std::optional<SymmetryPlane> symmetry_;
};

FarBox far_box(const TargetSurface& target, const SweptBody& body, const SweptSettings& settings) {
  FarBox box;
  box.axes = box_axes(body.axes);
  Box3 bounds;  // in the box's axes
  for (const Vec3& p : target.tessellation().points) {
    bounds.extend(Vec3(box.axes.chord.dot(p), box.axes.span.dot(p), box.axes.normal.dot(p)));
  }
  const double length = bounds.sizes().maxCoeff();
  const double half = settings.body_lengths * length;
  Vec3 centre = bounds.center();
  const bool open = body.ends[0] == SweptEnd::open;
  if (open) {
    centre.y() = body.sections.front().s;
    if (std::abs(centre.y()) < 1e-9 * target.diagonal()) centre.y() = 0;
  }
  if (!(half > (open ? 1.2 : 0.6) * length)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("a far field of {:.3g} body lengths does not clear the body", settings.body_lengths),
        "use --farfield-size 2 or more; 20 is usual");
  }
  box.low = centre - Vec3::Constant(half);
  box.high = centre + Vec3::Constant(half);
  if (open) box.low.y() = centre.y();
  return box;
}

}  // namespace

SweptBlocks make_swept_blocks(const TargetSurface& target, const SweptSettings& settings,
                              const std::string& source) {
  SweptBlocks out;
  out.body = find_swept_body(target, source);
  out.plan = make_swept_plan(out.body.trailing);
  SweptCage cage = make_swept_cage(target, out.body, out.plan);
  cage.cage.source = source;
  out.cage = cage.cage;
  const FarBox box = far_box(target, out.body, settings);
  out.box_axes = box.axes;
  Sweep(out, cage, box).make(source);
  return out;
}

std::vector<Index> cut_vertices(const SurfaceLevel& cut, const SurfaceLevel& level) {
  std::vector<Index> out(cut.vertex_count(), no_index);
  for (Index f = 0; f < cut.face_count(); ++f) {
    for (int c = 0; c < 4; ++c) out[cut.face_vertices[f][c]] = level.face_vertices[f][c];
  }
  return out;
}

}  // namespace flowcage
