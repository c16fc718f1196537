#pragma once
#include <Geom2d_Curve.hxx>
#include <TopoDS_Face.hxx>
#include <memory>
#include <string>
#include <vector>

#include "core/project/box_tree.hpp"
#include "core/project/cell_polynomial.hpp"
#include "core/project/closest_on_curve.hpp"
#include "core/project/oriented_tree.hpp"
#include "core/project/trimmed_cells.hpp"
#include "core/target/target_surface.hpp"
#include "occ_bridge/internal/face_outline.hpp"

namespace flowcage {

/// A face as the projector keeps it.
struct ProjectedFace {
  bool usable = false;
  bool reversed = false;  ///< the outer normal is -du x dv
  Index first_patch = 0, patch_count = 0;
  double trim_margin = 0;  ///< in space: nearer to the polygon than this, the exact classification decides
  std::unique_ptr<ExactClassifier> classifier;
};

/// One face's view of a border curve.
struct CurveSide {
  Index face = 0;
  Handle(Geom2d_Curve) pcurve;
};

struct BorderCurve {
  std::unique_ptr<ParametricCurve> curve;
  std::vector<CurveSide> sides;  ///< ascending face numbers; a seam has two of one face
};

/// A piece of a border curve between two parameters, within `slack` of the chord a b. A vertex off its curve
/// is a piece with a == b.
struct CurvePiece {
  Index curve = 0;
  double low = 0, high = 0;
  Vec3 a, b;
  double slack = 0;
  bool vertex = false;
};

/// Everything that the queries read; nothing in it changes after it is built.
struct ProjectionParts {
  double length = 0;  ///< the model's diagonal
  std::vector<ProjectedFace> faces;
  std::vector<std::unique_ptr<BoundedPatch>> patches;
  std::vector<Index> patch_face;
  TrimmedCells cells;
  std::vector<BorderCurve> curves;
  std::vector<CurvePiece> pieces;
  /// Of the cells and pieces, by their numbers; empty where a surface or curve is no polynomial to rounding.
  CellPolynomials cell_polynomials, piece_polynomials;
  BoxTree tree;            ///< items below cells.cells.size() are cells, the others pieces
  OrientedTree near_tree;  ///< the same items, for nearest points
  std::vector<std::string> notes;
};

ProjectionParts build_projection(const std::vector<TopoDS_Face>& faces);

/// See FaceProjector::normal.
Vec3 face_normal(const ProjectionParts& parts, Index face, const Vec2& uv);

}  // namespace flowcage
