#pragma once
#include <TopoDS_Face.hxx>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/target/target_surface.hpp"

namespace flowcage {

/// What a batch of nearest-point queries costs: sums over it.
struct ProjectionWork {
  Offset cells = 0, pieces = 0;  ///< looked at: box of it within reach
  Offset general_searches = 0;   ///< cells that several starts were needed for
  Offset evaluations = 0;        ///< of surfaces, by Newton's method
  Offset curve_evaluations = 0;  ///< of border curves
};

/// Exact projection to trimmed faces; the queries of TargetSurface (same meaning, same preconditions).
///
/// Each face's surface is cut into cells with a bound of their departure from flat, each edge's space curve
/// into pieces likewise; a box tree over both is searched, nearest first, with Newton's method in every cell
/// that may still hold a nearer point. A foot counts if it is inside of the trimming (own polygons, and the
/// kernel's classification near a border); otherwise the border curves answer. Vertices that lie off their
/// curves count as well. Ties go to the inside of a face, then to the lower face number.
///
/// closest_compatible considers, on each cell and border piece, the local minimum of the distance.
class FaceProjector {
 public:
  /// Faces with their location applied; lengths in metres. The face numbers of all results are positions in
  /// `faces`. A face that cannot be used is left out with a note.
  explicit FaceProjector(const std::vector<TopoDS_Face>& faces);
  ~FaceProjector();
  FaceProjector(FaceProjector&&) noexcept;
  FaceProjector& operator=(FaceProjector&&) noexcept;

  void closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                      std::span<SurfacePoint> results) const;
  void closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals, double min_cosine,
                          double max_distance, std::span<SurfacePoint> results) const;
  void intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions, double min_cosine,
                       double max_distance, std::span<SurfacePoint> results) const;

  /// The exact unit normal of a face at (u, v), on its oriented side; at a pole the limit from around it.
  Vec3 normal(Index face, const Vec2& uv) const;

  /// One line for each face that is left out or was simplified.
  const std::vector<std::string>& notes() const;

  /// The work of closest_points for the same queries and hints, for reports.
  ProjectionWork work(std::span<const Vec3> queries, std::span<const SurfacePoint> hints) const;

  /// Sizes of the search structure, for reports.
  Index cell_count() const;
  Index curve_piece_count() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace flowcage
