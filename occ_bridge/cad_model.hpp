#pragma once
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/target/open_borders.hpp"
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
  /// For reading and repairing, as damaged files can keep the kernel busy for ever: so long, and longer with
  /// the files' size (the slowest of 39 real files took 3 s of CPU time). The first again for uniting.
  double time_limit_seconds = 40, time_limit_per_megabyte = 60;
  bool unite = true;  ///< bodies that overlap or touch become their outer skin
  /// Which faces are taken, by name, layer, colour or number (docs/cad.md): those that match an `include`
  /// (all where there is none) and no `exclude`.
  std::vector<std::string> include{}, exclude{};
  /// Patch names that the user gives to faces, each with such a pattern and the option that gave it.
  struct NamedFaces {
    std::string name, pattern, option;
  };
  std::vector<NamedFaces> named{};
};

/// A face and what the files say of it; "" where they say nothing.
struct CadFace {
  Index number =
      0;  ///< from 1, in the order of the files: as read, so that the parts of a split face share it
  std::string name{};      ///< its own
  std::string solid{};     ///< its solid's, else its shell's
  std::string part{};      ///< its product's
  std::string instance{};  ///< of the product in the assembly: "left wing/flap:2"
  std::string layer{};
  std::string color{};  ///< "#rrggbb"
  std::string file{};   ///< its file's name without folder and extension
  std::string group{};  ///< the patch name that it offers: the first of these that tells faces apart
  std::string kind{};   ///< plane, cylinder, ...
  Box3 bounds{};        ///< of its triangles; empty where it has none
};

/// One file as it was found.
struct CadFile {
  std::string name;           ///< as given
  std::string format;         ///< STEP, IGES or BREP
  std::string unit;           ///< of the file: m, mm, in, ft, ...; "" where it says none
  double unit_in_metres = 0;  ///< of its numbers, after --cad-unit; 0: unknown to us, the kernel converts
  Index solids = 0, faces = 0;
  double diagonal = 0;  ///< in metres, with all its faces
};

struct NamedCount {
  std::string name;
  Index count = 0;
};

/// Bodies that pass through each other or touch, and what became of them.
struct CadOverlap {
  std::vector<Index> bodies;  ///< numbers from 1, in the order in which the model holds them before uniting
  bool united = false;
  Index split_faces = 0;    ///< cut along intersection curves
  Index hidden_pieces = 0;  ///< faces and pieces of faces left out, since they are inside of another body
  std::string problem;      ///< why they are not united
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
  Index free_edges_before = 0;                    ///< edges of one face, before sewing,
  Index free_edges_sewn = 0;                      ///< after it,
  Index free_edges = 0;                           ///< and after faces were split at kinks, edges with them
  double sewing_tolerance = 0;                    ///< used; 0: not sewn
  Index sharp_edges = 0, partly_sharp_edges = 0;  ///< the second: sharp on a part of their length only
  Index crowded_edges = 0;                        ///< of more than two faces
  Index sharp_chains = 0, boundary_chains = 0, corners = 0;
  Index tips = 0;  ///< apexes of cones
  std::vector<CadOverlap> overlaps;
  Index intersection_chains = 0;  ///< feature chains along which united bodies meet
  Index triangles = 0;
  Index faces_left_out = 0;                               ///< by include and exclude
  std::vector<OpenBorder> borders;                        ///< what the free edges are
  std::vector<Index> bad_faces;                           ///< numbers of faces without triangles
  std::vector<std::string> solid_names;                   ///< those that are not empty
  std::vector<NamedCount> groups, parts, layers, colors;  ///< with their faces, in the order of the faces
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

  const CadFace& face(Index face) const;
  const CadSummary& summary() const;

 private:
  std::shared_ptr<const Data> data_;
};

/// Reads, in a process of its own that a damaged file may crash, STEP, IGES and BREP files (told apart by
/// content) into one model. Sews what is open, makes closed shells solids, splits faces at sharp knot lines,
/// unites bodies that overlap or touch (docs/cad.md), and finds features. face_name() is the group of the
/// face. What can be worked around is a line in summary().warnings and progress.warn(). Throws Error(input)
/// naming the file for one that is missing, no CAD, cut off, damaged or without a surface, and Error(usage)
/// for a pattern of include or exclude that matches nothing.
CadModel read_cad(std::span<const std::string> files, const CadReadSettings& settings, Progress& progress);

/// The same for a shape built in code.
CadModel cad_model_of(const Shape& shape, const CadReadSettings& settings, Progress& progress);

}  // namespace flowcage
