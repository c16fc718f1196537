#pragma once
#include <BRepTopAdaptor_FClass2d.hxx>
#include <TopoDS_Face.hxx>
#include <memory>
#include <mutex>
#include <vector>

#include "core/project/trimmed_cells.hpp"

namespace flowcage {

/// A face's trimming in (u, v).
struct FaceOutline {
  Eigen::AlignedBox2d window;         ///< of the parameter curves
  std::vector<TrimSegment> segments;  ///< all loops, without what lies on the window's border
  bool bounded = false;  ///< by edges that are curves in space: none is missing, none collapsed to a point
  double precision = 0;  ///< in space, of the polygon against the parameter curves
};

/// Throws Standard_Failure or Error where an edge has no parameter curve.
FaceOutline face_outline(const TopoDS_Face& face, double precision);

/// A point of the window far from every segment.
Vec2 clear_point(const FaceOutline& outline);

/// The kernel's own exact classification. Its cache is shared, so calls are serialised: only for points near
/// a border.
class ExactClassifier {
 public:
  explicit ExactClassifier(TopoDS_Face face) : face_(std::move(face)) {}
  /// Inside, or on the border within the face's tolerance.
  bool inside(const Vec2& uv);

 private:
  TopoDS_Face face_;
  std::mutex mutex_;
  std::unique_ptr<BRepTopAdaptor_FClass2d> classifier_;
};

}  // namespace flowcage
