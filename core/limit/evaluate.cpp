#include "core/limit/evaluate.hpp"

#include <algorithm>
#include <cassert>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/limit/corner_patch.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/mesh/mirror.hpp"
#include "core/mesh/stencil_builder.hpp"
#include "core/subdivide/refine.hpp"

namespace flowcage {
namespace {

// A place on a quad and the derivatives of its (s,t) by the location's (u,v).
struct QuadPlace {
  Index face = 0;
  double s = 0, t = 0;
  double s_u = 1, s_v = 0, t_u = 0, t_v = 1;
};

// The same place on the next level, where child i of a quad has (0,0) at the quad's corner i.
QuadPlace on_child(const QuadPlace& at, const SurfaceLevel& level) {
  const double x = 2 * at.s, y = 2 * at.t;
  const auto first = static_cast<Index>(level.face_vertices.offsets[at.face]);
  if (x <= 1 && y <= 1) return {first, x, y, 2 * at.s_u, 2 * at.s_v, 2 * at.t_u, 2 * at.t_v};
  if (y <= 1) return {first + 1, y, 2 - x, 2 * at.t_u, 2 * at.t_v, -2 * at.s_u, -2 * at.s_v};
  if (x <= 1) return {first + 3, 2 - y, x, -2 * at.t_u, -2 * at.t_v, 2 * at.s_u, 2 * at.s_v};
  return {first + 2, 2 - x, 2 - y, -2 * at.s_u, -2 * at.s_v, -2 * at.t_u, -2 * at.t_v};
}

// Whether every face is a quad whose corners 1, 2 and 3 are regular, as on a child level of quads: corner 0
// is the parent's vertex, 1 and 3 are edge points, 2 is a face point with as many edges as the parent's face.
bool has_patch_quads(const SurfaceLevel& level) {
  if (level.depth == 0) return false;
  for (Index f = 0; f < level.face_count(); ++f) {
    if (level.vertex_edges.row_size(level.face_vertices[f][2]) != 4) return false;
  }
  return true;
}

template <typename Row>
Index place_in(const Row& row, Index value) {
  return static_cast<Index>(std::find(row.begin(), row.end(), value) - row.begin());
}

// The control points round child quads of a level with only quads, in the order of PatchShape.
class Neighbourhood {
 public:
  Neighbourhood(const SurfaceLevel& level, Index face) : level_(level), face_(face) {
    const Index vertex = level.face_vertices[face][0];
    const auto edges = level.vertex_edges[vertex];
    const auto faces = level.vertex_faces[vertex];
    first_ = place_in(faces, face);
    shape.edge_count = static_cast<int>(edges.size());
    shape.face_count = static_cast<int>(faces.size());
    if (edges.size() >
        faces.size()) {  // a boundary ring has a start of its own, any other starts at the quad
      shape.face = first_;
      first_ = 0;
    }
    shape.vertex_sharpness = level.vertex_sharpness[vertex];
    for (int i = 0; i < shape.edge_count; ++i) {
      shape.edge_sharpness.push_back(level.edge_sharpness[edges[ring(i)]]);
    }
  }

  PatchShape shape;

  std::vector<Index> vertices() const {
    const Index vertex = level_.face_vertices[face_][0];
    std::vector<Index> list{vertex};
    for (int i = 0; i < shape.edge_count; ++i) {
      const auto& ends = level_.edge_vertices[level_.vertex_edges[vertex][ring(i)]];
      list.push_back(ends[ends[0] == vertex ? 1 : 0]);
    }
    for (int i = 0; i < shape.face_count; ++i) {
      const auto row = level_.face_vertices[level_.vertex_faces[vertex][ring(i)]];
      list.push_back(row[(place_in(row, vertex) + 2) % 4]);
    }
    // Outer points, each as a corner of a face behind an edge; see the drawing in corner_patch.hpp.
    const Side e_to_f{face_, 1}, f_to_g{face_, 2};
    const Side right = across(e_to_f), top = across(f_to_g);
    const Index a0 = corner(right, 2), b0 = corner(right, 3);
    const Index b1 = corner(top, 2), a1 = corner(top, 3);
    const Index d = corner(across(next(right, 3)), 2);
    const Side below = across(next(right, 1)), left = across(next(top, 3));
    const Index c0 = below.face == no_index ? no_index : corner(below, 3);
    const Index c1 = left.face == no_index ? no_index : corner(left, 2);
    list.insert(list.end(), {c0, a0, b0, d, b1, a1, c1});
    return list;
  }

 private:
  // A side of a quad: from its corner `side` to the next.
  struct Side {
    Index face, side;
  };
  int ring(int i) const { return static_cast<int>((first_ + i) % shape.edge_count); }
  static Side next(const Side& at, Index steps) { return {at.face, (at.side + steps) % 4}; }
  Side across(const Side& at) const {
    const Index e = level_.face_edges[at.face][at.side];
    const auto& faces = level_.edge_faces[e];
    const Index other = faces[faces[0] == at.face ? 1 : 0];
    return other == no_index ? Side{no_index, 0} : Side{other, place_in(level_.face_edges[other], e)};
  }
  Index corner(const Side& at, Index steps) const {
    return level_.face_vertices[at.face][(at.side + steps) % 4];
  }

  const SurfaceLevel& level_;
  Index face_, first_ = 0;
};

}  // namespace

struct LimitEvaluator::Tables {
  std::vector<SurfaceLevel> levels;  // the given one to the one that the patches lie on
  StencilTable refine;               // vertices of the last in those of the first; levels.size() > 1
  PatchShapes shapes;
  std::vector<int> face_shape;            // by face of the last level
  std::optional<MirrorExtension> around;  // the last level with its mirror images

  QuadPlace find(const LimitLocation& at) const {
    assert(at.face >= 0 && at.face < levels.front().face_count());
    const auto inside = [](double x) { return x > 0 ? std::min(x, 1.0) : 0.0; };
    QuadPlace place{at.face, inside(at.u), inside(at.v)};
    std::size_t level = 0;
    if (levels.front().face_vertices.row_size(at.face) != 4) {
      place.face = static_cast<Index>(levels.front().face_vertices.offsets[at.face]) + at.corner;
      level = 1;
    }
    for (; level + 1 < levels.size(); ++level) place = on_child(place, levels[level]);
    return place;
  }

  // Calls add(row, vertex, weight, weights by axis) for position (0), du (1) and dv (2).
  template <typename Add>
  void for_each_term(const LimitLocation& at, const Add& add) const {
    const QuadPlace place = find(at);
    const PatchRows rows = shapes.evaluate(face_shape[place.face], place.s, place.t);
    const std::vector<Index> vertices = Neighbourhood(around->level(), place.face).vertices();
    const MirrorFold* const fold = around->fold();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i] == no_index) continue;
      const auto column = rows.col(static_cast<Eigen::Index>(i));
      const double du = column[1] * place.s_u + column[2] * place.t_u;
      const double dv = column[1] * place.s_v + column[2] * place.t_v;
      const Index vertex = fold == nullptr ? vertices[i] : fold->original_of(vertices[i]);
      const Vec3 factors = fold == nullptr ? Vec3::Ones() : fold->factors(vertices[i]);
      if (levels.size() == 1) {
        add(0, vertex, column[0], Vec3(column[0] * factors));
        add(1, vertex, du, Vec3(du * factors));
        add(2, vertex, dv, Vec3(dv * factors));
        continue;
      }
      for (Offset k = refine.offsets[vertex]; k < refine.offsets[vertex + 1]; ++k) {
        const double weight = refine.weights[k];
        const Vec3 by_axis = fold == nullptr ? Vec3(Vec3::Constant(weight))
                                             : Vec3(factors.cwiseProduct(refine.term_weights(k)));
        add(0, refine.indices[k], column[0] * weight, Vec3(column[0] * by_axis));
        add(1, refine.indices[k], du * weight, Vec3(du * by_axis));
        add(2, refine.indices[k], dv * weight, Vec3(dv * by_axis));
      }
    }
  }
};

LimitEvaluator::LimitEvaluator(SurfaceLevel level) {
  auto tables = std::make_unique<Tables>();
  tables->levels.push_back(std::move(level));
  while (!has_patch_quads(tables->levels.back())) {
    const SurfaceLevel& above = tables->levels.back();
    StencilTable refine = refinement_stencils(above);
    if (tables->levels.size() > 1) refine = compose(refine, tables->refine);
    tables->refine = std::move(refine);
    tables->levels.push_back(build_child_level(above));
  }
  tables->around.emplace(tables->levels.back());
  for (Index f = 0; f < tables->levels.back().face_count(); ++f) {
    tables->face_shape.push_back(tables->shapes.prepare(Neighbourhood(tables->around->level(), f).shape));
  }
  tables_ = std::move(tables);
}
LimitEvaluator::~LimitEvaluator() = default;
LimitEvaluator::LimitEvaluator(LimitEvaluator&&) noexcept = default;
LimitEvaluator& LimitEvaluator::operator=(LimitEvaluator&&) noexcept = default;

LimitPoint LimitEvaluator::evaluate(std::span<const Vec3> points, const LimitLocation& at) const {
  assert(static_cast<Index>(points.size()) == tables_->levels.front().vertex_count());
  const Vec3& origin = tables_->levels.front().mirrors.value;
  std::array<Vec3, 3> sum{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  tables_->for_each_term(at, [&](int row, Index vertex, double, const Vec3& by_axis) {
    sum[row] += by_axis.cwiseProduct(points[vertex] - origin);
  });
  return {sum[0] + origin, sum[1], sum[2]};
}

EvaluationStencils evaluation_stencils(const LimitEvaluator& evaluator,
                                       std::span<const LimitLocation> locations) {
  const LimitEvaluator::Tables& all = *evaluator.tables_;
  const MirrorFold* const fold = all.around->fold();
  auto tables = build_stencil_tables<3>(
      static_cast<Offset>(locations.size()), all.levels.front().vertex_count(),
      [&](Index begin, Index end, std::span<StencilWriter, 3> out) {
        for (Index i = begin; i < end; ++i) {
          all.for_each_term(locations[i], [&](int row, Index vertex, double weight, const Vec3& by_axis) {
            if (fold == nullptr) {
              out[row].add(vertex, weight);
            } else {
              out[row].add(vertex, weight, by_axis);
            }
          });
          for (StencilWriter& writer : out) writer.end_row();
        }
      },
      fold);
  tables[1].of_vectors = tables[2].of_vectors = true;
  return {std::move(tables[0]), std::move(tables[1]), std::move(tables[2])};
}

SampledSurface sample_limit_surface(const SurfaceLevel& level, std::span<const Vec3> points, int splits) {
  assert(static_cast<Index>(points.size()) == level.vertex_count() && splits >= 0);
  SampledSurface sampled;
  sampled.topology = level;
  std::vector<Vec3> control(points.begin(), points.end());
  for (int k = 0; k < splits; ++k) {
    std::vector<SurfaceLevel> pair{std::move(sampled.topology), {}};
    pair[1] = build_child_level(pair[0]);
    control = refine_points(pair, std::move(control));
    sampled.topology = std::move(pair[1]);
  }
  sampled.points = apply_stencils(limit_stencils(sampled.topology), control);
  const TangentStencils tangents = tangent_stencils(sampled.topology);
  const std::vector<Vec3> u = apply_stencils(tangents.u, control), v = apply_stencils(tangents.v, control);
  sampled.normals.resize(u.size());
  parallel_for(static_cast<Offset>(u.size()), 8192, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      const Vec3 normal = u[i].normalized().cross(v[i].normalized());
      const double length = normal.norm();
      sampled.normals[i] = length > 1e-14 ? Vec3(normal / length) : Vec3(Vec3::Zero());
    }
  });
  return sampled;
}

}  // namespace flowcage
