#pragma once
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/target/target_surface.hpp"
#include "occ_bridge/shapes.hpp"

namespace flowcage {

/// How CAD files become a target. Angles in degrees, tolerances relative to the bounding box's diagonal.
struct CadReadSettings {
  std::string cad_unit;                                     ///< m, mm, cm, in or ft; "": what the files say
  double crease_angle_degrees = 20;                         ///< an edge with a larger angle is sharp
  double corner_angle_degrees = 30;                         ///< a chain that turns by more has a corner there
  std::vector<double> sewing_tolerances{1e-6, 1e-5, 1e-4};  ///< tried in this order until nothing is open
  double deflection = 1e-3;                                 ///< of the tessellation from the exact surface
  double tessellation_angle_degrees = 15;
  double time_limit_seconds =
      300;  ///< for reading and repairing: damaged files can keep the kernel busy for ever
};

/// One file as it was found.
struct CadFile {
  std::string name;           ///< as given
  std::string format;         ///< STEP, IGES or BREP
  std::string unit;           ///< of the file: m, mm, in, ft, ...; "" where it says none
  double unit_in_metres = 0;  ///< of its numbers, after --cad-unit; 0: unknown to us, the kernel converts
  Index solids = 0, faces = 0;
};

struct NamedCount {
  std::string name;
  Index count = 0;
};

/// What `flowcage inspect` shows. Lengths in metres; counts are of the sewn model.
struct CadSummary {
  std::vector<CadFile> files;
  std::string unit;  ///< of the first file, or the one that overruled it
  Box3 bounds;
  double diagonal = 0;
  Index solids = 0, shells = 0, open_shells = 0;
  Index faces = 0, edges = 0, vertices = 0;       ///< edges without the degenerate ones (poles)
  std::vector<NamedCount> faces_by_kind;          ///< plane, cylinder, ..., most frequent first
  Index free_edges_before = 0, free_edges = 0;    ///< edges of one face, before and after sewing
  double sewing_tolerance = 0;                    ///< used; 0: not sewn
  Index sharp_edges = 0, partly_sharp_edges = 0;  ///< the second: sharp on a part of their length only
  Index crowded_edges = 0;                        ///< of more than two faces
  Index sharp_chains = 0, boundary_chains = 0, corners = 0;
  Index triangles = 0;
  std::vector<std::string> solid_names, face_names;  ///< those that are not empty; face names once each
  std::vector<std::string> warnings;
  bool closed() const { return faces > 0 && free_edges == 0; }
};

/// A CAD model as the target of a fit: trimmed faces, sharp and open edges, in metres. Faces of closed bodies
/// point outward; open ones keep the side that they have in the file. Thread-safe.
///
/// Chains: edges that are sharp (exact normals, sampled along the edge, differ by more than the crease angle)
/// or open, joined end to end between corners. A corner is a vertex where not exactly two such edges of one
/// kind meet, or where they turn by more than the corner angle. Arc lengths are accurate to 1e-10 of the
/// chain's length.
class CadModel final : public TargetSurface {
 public:
  struct Data;  // occ_bridge/internal/cad_data.hpp
  explicit CadModel(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  void closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                      std::span<SurfacePoint> results) const override;
  void closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals, double min_cosine,
                          double max_distance, std::span<SurfacePoint> results) const override;
  void intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions, double min_cosine,
                       double max_distance, std::span<SurfacePoint> results) const override;
  const FeatureGraph& features() const override;
  CurvePoint chain_point(Index chain, double s) const override;
  CurvePoint closest_on_chain(Index chain, const Vec3& query) const override;
  const Tessellation& tessellation() const override;
  Index face_count() const override;
  std::string face_name(Index face) const override;
  Box3 bounds() const override;

  const CadSummary& summary() const;

 private:
  std::shared_ptr<const Data> data_;
};

/// Reads, in a process of its own that a damaged file may crash, STEP, IGES and BREP files (told apart by
/// content) into one model. Sews what is open, makes closed shells solids, splits faces at sharp knot lines,
/// and finds features. What can be worked around is a line in summary().warnings and progress.warn(). Throws
/// Error(input) naming the file for one that is missing, no CAD, cut off, damaged or without a surface.
CadModel read_cad(std::span<const std::string> files, const CadReadSettings& settings, Progress& progress);

/// The same for a shape built in code.
CadModel cad_model_of(const Shape& shape, const CadReadSettings& settings, Progress& progress);

}  // namespace flowcage
