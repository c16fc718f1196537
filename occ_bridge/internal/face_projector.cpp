#include "occ_bridge/internal/face_projector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "occ_bridge/internal/closest_search.hpp"
#include "occ_bridge/internal/line_search.hpp"
#include "occ_bridge/internal/projection_parts.hpp"

namespace flowcage {
namespace {

constexpr Offset batch_grain = 256;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Distance within which the answer must lie, from a point that is already known to be on the faces.
double known_reach(const ProjectionParts& parts, const Vec3& query, const SurfacePoint& known) {
  if (known.status == FootStatus::failed || known.face < 0 ||
      known.face >= static_cast<Index>(parts.faces.size())) {
    return infinity;
  }
  const double distance = (query - known.position).norm();
  return std::isfinite(distance) ? distance * (1 + 1e-12) + 1e-9 * parts.length : infinity;
}

struct ClosestBatch {
  std::span<const Vec3> queries;
  std::span<const SurfacePoint> hints;
  std::span<SurfacePoint> results;
};

ProjectionWork closest_in_range(const ProjectionParts& parts, const ClosestBatch& batch, Offset begin,
                                Offset end) {
  ClosestSearch search(parts);
  SurfacePoint last;
  for (Offset i = begin; i < end; ++i) {
    const Vec3& query = batch.queries[i];
    batch.results[i] = SurfacePoint{};
    if (!query.allFinite()) continue;
    double reach = known_reach(parts, query, last);
    if (!batch.hints.empty()) reach = std::min(reach, known_reach(parts, query, batch.hints[i]));
    SurfacePoint found = search.run(query, reach, {});
    // A hint that is no point of these faces promised too much.
    if (found.status == FootStatus::failed && reach < infinity) found = search.run(query, infinity, {});
    if (found.status != FootStatus::failed) last = found;
    batch.results[i] = found;
  }
  return search.work();
}

}  // namespace

struct FaceProjector::Parts : ProjectionParts {
  explicit Parts(ProjectionParts&& parts) : ProjectionParts(std::move(parts)) {}
};

FaceProjector::FaceProjector(const std::vector<TopoDS_Face>& faces)
    : parts_(std::make_unique<Parts>(build_projection(faces))) {}
FaceProjector::~FaceProjector() = default;
FaceProjector::FaceProjector(FaceProjector&&) noexcept = default;
FaceProjector& FaceProjector::operator=(FaceProjector&&) noexcept = default;

void FaceProjector::closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                                   std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), batch_grain, [&](Offset begin, Offset end) {
    closest_in_range(*parts_, {queries, hints, results}, begin, end);
  });
}

ProjectionWork FaceProjector::work(std::span<const Vec3> queries, std::span<const SurfacePoint> hints) const {
  std::vector<SurfacePoint> results(queries.size());
  return parallel_reduce(
      static_cast<Offset>(queries.size()), batch_grain, ProjectionWork{},
      [&](Offset begin, Offset end) {
        return closest_in_range(*parts_, {queries, hints, results}, begin, end);
      },
      [](ProjectionWork sum, const ProjectionWork& part) {
        sum.cells += part.cells;
        sum.pieces += part.pieces;
        sum.general_searches += part.general_searches;
        sum.evaluations += part.evaluations;
        sum.curve_evaluations += part.curve_evaluations;
        return sum;
      });
}

void FaceProjector::closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals,
                                       double min_cosine, double max_distance,
                                       std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), batch_grain, [&](Offset begin, Offset end) {
    ClosestSearch search(*parts_);
    for (Offset i = begin; i < end; ++i) {
      results[i] = SurfacePoint{};
      if (!queries[i].allFinite() || !normals[i].allFinite()) continue;
      results[i] = search.run(queries[i], max_distance, {&normals[i], min_cosine});
    }
  });
}

void FaceProjector::intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions,
                                    double min_cosine, double max_distance,
                                    std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), batch_grain, [&](Offset begin, Offset end) {
    LineSearch search(*parts_);
    for (Offset i = begin; i < end; ++i) {
      results[i] = SurfacePoint{};
      if (!queries[i].allFinite() || !directions[i].allFinite()) continue;
      results[i] = search.run(queries[i], directions[i], min_cosine, max_distance);
    }
  });
}

Vec3 FaceProjector::normal(Index face, const Vec2& uv) const {
  return face_normal(*parts_, face, uv);
}

const std::vector<std::string>& FaceProjector::notes() const {
  return parts_->notes;
}

Index FaceProjector::cell_count() const {
  return static_cast<Index>(parts_->cells.cells.size());
}

Index FaceProjector::curve_piece_count() const {
  return static_cast<Index>(parts_->pieces.size());
}

}  // namespace flowcage
