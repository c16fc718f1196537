#include "core/limit/bicubic_patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/limit/corner_cells.hpp"
#include "core/limit/quad_blocks.hpp"
#include "core/limit/spline_interpolation.hpp"
#include "core/subdivide/refine.hpp"

namespace flowcage {
namespace {

// The level that is cut into blocks, and what evaluates its limit surface.
struct Blocks {
  SurfaceLevel level;
  std::vector<Vec3> points;
  std::vector<QuadBlock> blocks;
};

bool is_plain(const SurfaceLevel& level) {
  const auto semi_sharp = [](double s) { return s > 0 && s < infinitely_sharp; };
  for (Index f = 0; f < level.face_count(); ++f) {
    if (level.face_vertices.row_size(f) != 4) return false;
  }
  return std::none_of(level.edge_sharpness.begin(), level.edge_sharpness.end(), semi_sharp) &&
         std::none_of(level.vertex_sharpness.begin(), level.vertex_sharpness.end(), semi_sharp);
}

Blocks refine_to_blocks(SurfaceLevel level, std::vector<Vec3> points, Progress& progress) {
  while (true) {
    progress.step("patches", 0);
    if (is_plain(level)) {
      if (auto blocks = partition_into_blocks(level)) {
        return {std::move(level), std::move(points), std::move(*blocks)};
      }
    }
    constexpr Offset most_quads = 30'000'000;
    if (static_cast<Offset>(level.face_vertices.values.size()) > most_quads) {
      throw Error(
          ErrorKind::usage,
          fmt::format("B-spline patches: semi-sharp creases of the cage need more than {} quads", most_quads),
          "make these creases infinitely sharp (10) or blunter in the cage");
    }
    points = apply_stencils(refinement_stencils(level), points);
    level = build_child_level(level);
  }
}

// The surface of one block as a function of (u,v), counted in quads.
class BlockFunction {
 public:
  BlockFunction(const QuadBlock& block, const Blocks& all, const LimitEvaluator& evaluator,
                const std::vector<CornerCell>& cells)
      : block_(block), points_(all.points), evaluator_(evaluator) {
    const Index m = block.count_u, n = block.count_v;
    const std::array<Index, 4> at{0, m - 1, m * n - 1, m * (n - 1)};
    for (int q = 0; q < 4; ++q) {
      const Index face = block.faces[at[q]], corner = (block.turns[at[q]] + q) % 4;
      cells_[q] = cells[all.level.face_vertices.offsets[face] + corner];
    }
  }

  // The cell that holds the place, if one does: its corner number and the place seen from there.
  struct InCell {
    int corner;
    Vec2 ab;
  };
  std::optional<InCell> find_cell(const Vec2& uv) const {
    for (int q = 0; q < 4; ++q) {
      if (cells_[q].depth == 0) continue;
      const Vec2 ab = seen_from(q, uv);
      if (std::max(ab.x(), ab.y()) <= cells_[q].size()) return InCell{q, ab};
    }
    return std::nullopt;
  }
  bool in_pointed_cell(const Vec2& uv) const {
    const auto at = find_cell(uv);
    return at && cells_[at->corner].pointed;
  }
  Vec3 position(const Vec2& uv) const {
    if (const auto at = find_cell(uv)) return cells_[at->corner].position(at->ab);
    return limit(uv);
  }
  // Of a point near (u,v) from the exact surface.
  double deviation(const Vec2& uv, const Vec3& p) const {
    const auto [corner, ab] = locate(uv);
    return distance_to_limit(evaluator_, points_, corner, ab, p);
  }
  Vec3 limit(const Vec2& uv) const {
    const auto [corner, ab] = locate(uv);
    return evaluate_at_corner(evaluator_, points_, corner, ab).position;
  }

  // Flat knots along u or v: whole numbers, and rings toward corners that have a cell.
  std::vector<double> knots(bool along_u) const {
    const double end = along_u ? block_.count_u : block_.count_v;
    std::vector<double> inner, doubled;
    for (int k = 1; k < end; ++k) inner.push_back(k);
    for (int q = 0; q < 4; ++q) {
      const bool at_start = along_u ? q == 0 || q == 3 : q < 2;
      for (int k = 1; k <= cells_[q].depth; ++k) {
        const double ring = at_start ? std::ldexp(1.0, -k) : end - std::ldexp(1.0, -k);
        inner.push_back(ring);
      }
      // The cell's own knots are double.
      for (int k = 1; k <= CornerCell::segments && cells_[q].depth > 0; ++k) {
        const double x = cells_[q].size() * k / CornerCell::segments;
        doubled.push_back(at_start ? x : end - x);
        inner.push_back(doubled.back());
      }
    }
    const auto make_set = [](std::vector<double>& values) {
      std::sort(values.begin(), values.end());
      values.erase(std::unique(values.begin(), values.end()), values.end());
    };
    make_set(inner);
    make_set(doubled);
    std::vector<double> flat(4, 0.0);
    std::merge(inner.begin(), inner.end(), doubled.begin(), doubled.end(), std::back_inserter(flat));
    flat.insert(flat.end(), 4, end);
    return flat;
  }

 private:
  struct Location {
    FaceCorner corner;
    Vec2 ab;
  };
  Location locate(const Vec2& uv) const {
    const auto cell = [](double x, Index count) { return std::clamp(static_cast<Index>(x), 0, count - 1); };
    const Index i = cell(uv.x(), block_.count_u), j = cell(uv.y(), block_.count_v);
    const Index at = i + block_.count_u * j;
    return {{block_.faces[at], block_.turns[at]}, uv - Vec2(i, j)};
  }
  Vec2 seen_from(int corner, const Vec2& uv) const {
    const double u = uv.x(), v = uv.y(), m = block_.count_u, n = block_.count_v;
    return std::array<Vec2, 4>{Vec2(u, v), Vec2(v, m - u), Vec2(m - u, n - v), Vec2(n - v, u)}[corner];
  }

  const QuadBlock& block_;
  std::span<const Vec3> points_;
  const LimitEvaluator& evaluator_;
  std::array<CornerCell, 4> cells_;
};

BSplineSurface interpolate(const BlockFunction& function) {
  const CubicInterpolation along_u(function.knots(true)), along_v(function.knots(false));
  const auto count_u = static_cast<Offset>(along_u.sites().size());
  const auto count_v = static_cast<Offset>(along_v.sites().size());
  BSplineSurface surface{3, 3, along_u.knots(), along_v.knots(), {}, {}};
  surface.poles.resize(static_cast<std::size_t>(count_u * count_v));
  parallel_for(count_u, 4, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      Vec3* row = surface.poles.data() + i * count_v;
      for (Offset j = 0; j < count_v; ++j) {
        row[j] = function.position({along_u.sites()[i], along_v.sites()[j]});
      }
      along_v.solve(row, 1);
    }
  });
  parallel_for(count_v, 16, [&](Offset begin, Offset end) {
    for (Offset j = begin; j < end; ++j) along_u.solve(surface.poles.data() + j, count_v);
  });
  return surface;
}

// Sides of blocks, face by face, counter-clockwise.
struct SideWalk {
  const SurfaceLevel& level;
  const QuadBlock& block;

  Index length(int side) const { return side % 2 == 0 ? block.count_u : block.count_v; }
  std::array<Index, 2> face_and_corner(int side, Index k) const {
    const Index m = block.count_u, n = block.count_v;
    const std::array<Index, 4> cell{k, m - 1 + m * k, m * n - 1 - k, m * (n - 1 - k)};
    return {block.faces[cell[side]], (block.turns[cell[side]] + side) % 4};
  }
  Index vertex(int side, Index k) const {
    const auto [face, corner] = face_and_corner(side, k);
    return level.face_vertices[face][corner];
  }
  Index edge(int side, Index k) const {
    const auto [face, corner] = face_and_corner(side, k);
    return level.face_edges[face][corner];
  }
};

// Nodes are corners of blocks; edges the pieces of sides between them.
class Connection {
 public:
  Connection(const Blocks& all, PatchSurface& surface)
      : all_(all),
        surface_(surface),
        node_(static_cast<std::size_t>(all.level.vertex_count()), no_index),
        edge_of_(all.level.edge_vertices.size(), no_index) {}

  // `position(block, corner)`: of block corners 0 .. 3.
  template <typename Position>
  void build(const Position& position) {
    for (std::size_t b = 0; b < all_.blocks.size(); ++b) {
      const SideWalk walk{all_.level, all_.blocks[b]};
      for (int side = 0; side < 4; ++side) {
        Index& node = node_[walk.vertex(side, 0)];
        if (node != no_index) continue;
        node = static_cast<Index>(surface_.nodes.size());
        surface_.nodes.push_back(position(b, side));
      }
    }
    for (std::size_t b = 0; b < all_.blocks.size(); ++b) {
      for (int side = 0; side < 4; ++side) add_side(static_cast<Index>(b), side);
    }
  }

 private:
  void add_side(Index patch, int side) {
    const SideWalk walk{all_.level, all_.blocks[patch]};
    const Index length = walk.length(side);
    for (Index start = 0; start < length;) {
      Index end = start + 1;
      while (end < length && node_[walk.vertex(side, end)] == no_index) ++end;
      const Index known = edge_of_[walk.edge(side, start)];
      const bool forward = known == no_index;
      const Index number = forward ? static_cast<Index>(surface_.edges.size()) : known;
      if (forward) {
        PatchEdge edge;
        const Index last = end == length ? walk.vertex((side + 1) % 4, 0) : walk.vertex(side, end);
        edge.nodes = {node_[walk.vertex(side, start)], node_[last]};
        edge.crease = all_.level.edge_sharpness[walk.edge(side, start)] > 0;
        surface_.edges.push_back(edge);
        for (Index k = start; k < end; ++k) edge_of_[walk.edge(side, k)] = number;
      }
      PatchEdge& edge = surface_.edges[number];
      assert(edge.use_count < 2);
      const Index from = side < 2 ? start : length - end, to = side < 2 ? end : length - start;
      edge.uses[edge.use_count++] = {patch, side, static_cast<double>(from), static_cast<double>(to)};
      surface_.patches[patch].boundary.push_back({number, forward});
      start = end;
    }
  }

  const Blocks& all_;
  PatchSurface& surface_;
  std::vector<Index> node_, edge_of_;
};

BSplinePatch whole(const BSplineSurface& surface) {
  const Vec2 end(surface.knots_u.back(), surface.knots_v.back());
  return {std::make_shared<const BSplineSurface>(surface), Eigen::AlignedBox2d(Vec2(0, 0), end)};
}

double largest_deviation(const BlockFunction& function, const BSplinePatch& patch, double negligible) {
  const std::vector<double> u = patch.breaks(0), v = patch.breaks(1);
  const auto at = [&](double x, double y) {
    const Vec3 p = patch.first({x, y}).position;
    const double same_parameters = (p - function.limit({x, y})).norm();
    return same_parameters <= negligible ? same_parameters : function.deviation({x, y}, p);
  };
  return parallel_reduce<double>(
      static_cast<Offset>(u.size()) - 1, 2, 0.0,
      [&](Offset begin, Offset end) {
        double largest = 0;
        for (Offset i = begin; i < end; ++i) {
          for (std::size_t j = 0; j + 1 < v.size(); ++j) {
            const Vec2 low(u[i], v[j]), size(u[i + 1] - u[i], v[j + 1] - v[j]);
            const int steps = function.find_cell(low + 0.5 * size) ? 5 : 1;
            for (int a = 0; a < steps; ++a) {
              for (int b = 0; b < steps; ++b) {
                largest = std::max(largest, at(low.x() + size.x() * (a + 0.4) / steps,
                                               low.y() + size.y() * (b + 0.6) / steps));
              }
            }
          }
        }
        return largest;
      },
      [](double a, double b) { return std::max(a, b); });
}

// The place on a patch's side at distance t from the edge's start.
Vec2 on_side(const BSplineSurface& s, const PatchSide& use, bool forward, double t) {
  const double x = (use.side < 2) == forward ? use.from + t : use.to - t;
  const std::array<Vec2, 4> places{Vec2(x, 0), Vec2(s.knots_u.back(), x), Vec2(x, s.knots_v.back()),
                                   Vec2(0, x)};
  return places[use.side];
}

// The largest angle along an edge, at knots of both sides and between.
void measure_angle(const PatchEdge& edge, const std::vector<BSplinePatch>& patches,
                   const std::vector<BlockFunction>& functions, PatchSurface& surface) {
  const double length = edge.uses[0].to - edge.uses[0].from;
  std::vector<double> breaks{0, length};
  for (int k = 0; k < 2; ++k) {
    const PatchSide& use = edge.uses[k];
    const BSplineSurface& s = surface.patches[use.patch].surface;
    for (const double knot : use.side % 2 == 0 ? s.knots_u : s.knots_v) {
      if (knot <= use.from || knot >= use.to) continue;
      breaks.push_back((use.side < 2) == (k == 0) ? knot - use.from : use.to - knot);
    }
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  const auto normal = [&](int k, double t, Vec3& position) {
    const PatchSide& use = edge.uses[k];
    const Vec2 uv = on_side(surface.patches[use.patch].surface, use, k == 0, t);
    const PatchPoint p = patches[use.patch].first(uv);
    position = p.position;
    return functions[use.patch].in_pointed_cell(uv) ? Vec3(Vec3::Zero()) : Vec3(p.du.cross(p.dv));
  };
  constexpr int steps = 6;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    for (int step = 0; step <= steps; ++step) {
      const double t = breaks[k] + (breaks[k + 1] - breaks[k]) * step / steps;
      Vec3 place;
      const Vec3 m = normal(0, t, place), n = normal(1, t, place);
      const double angle = std::atan2(m.cross(n).norm(), m.dot(n)) * 180 / std::numbers::pi;
      if (angle > surface.max_angle_degrees) {
        surface.max_angle_degrees = angle;
        surface.worst_angle_place = place;
      }
    }
  }
}

}  // namespace

PatchSurface make_bicubic_patches(SurfaceLevel level, std::vector<Vec3> points, const PatchSettings& settings,
                                  Progress& progress) {
  assert(static_cast<Index>(points.size()) == level.vertex_count());
  const Blocks all = refine_to_blocks(std::move(level), std::move(points), progress);
  Box3 box;
  for (const Vec3& p : all.points) box.extend(p);
  const double diagonal = box.diagonal().norm();
  const LimitEvaluator evaluator(all.level);
  CornerCellSettings cell_settings;
  cell_settings.max_angle_degrees = settings.max_angle_degrees;
  cell_settings.max_deviation = settings.max_deviation * diagonal;
  progress.step("patches", 0.1);
  const std::vector<CornerCell> cells = fit_corner_cells(all.level, evaluator, all.points, cell_settings);

  PatchSurface surface;
  std::vector<BlockFunction> functions;
  std::vector<BSplinePatch> patches;
  for (const QuadBlock& block : all.blocks) functions.emplace_back(block, all, evaluator, cells);
  for (std::size_t b = 0; b < all.blocks.size(); ++b) {
    progress.step("patches", 0.2 + 0.8 * static_cast<double>(b) / static_cast<double>(all.blocks.size()));
    BicubicPatch& patch = surface.patches.emplace_back();
    patch.surface = interpolate(functions[b]);
    patch.name = all.blocks[b].patch;
    patches.push_back(whole(patch.surface));
    surface.max_deviation =
        std::max(surface.max_deviation, largest_deviation(functions[b], patches[b], 1e-10 * diagonal));
  }
  Connection(all, surface).build([&](std::size_t block, int corner) {
    const double m = all.blocks[block].count_u, n = all.blocks[block].count_v;
    return functions[block].position(
        std::array<Vec2, 4>{Vec2(0, 0), Vec2(m, 0), Vec2(m, n), Vec2(0, n)}[corner]);
  });
  for (const PatchEdge& edge : surface.edges) {
    if (edge.use_count == 2 && !edge.crease) measure_angle(edge, patches, functions, surface);
  }
  return surface;
}

}  // namespace flowcage
