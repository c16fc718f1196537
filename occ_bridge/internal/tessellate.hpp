#pragma once
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/target/target_surface.hpp"
#include "occ_bridge/internal/face_edges.hpp"
#include "occ_bridge/internal/face_labels.hpp"

namespace flowcage::occ {

struct TessellateSettings {
  double deflection = 0;      ///< largest distance from the exact shape, in its length unit
  double scale = 1;           ///< metres per length unit, for the places in warnings
  double angle_degrees = 15;  ///< largest turn along an edge from one segment to the next
};

/// Stores a triangulation in every face of the shape. A face that cannot be triangulated costs a warning
/// that gives its number and place, and is one of the summary's bad faces.
void triangulate_faces(const TopoDS_Shape& shape, const TessellateSettings& settings,
                       const FaceLabels& labels, CadSummary& summary, Progress& progress);

/// The triangles of all faces, numbered as in `topology`, in metres (`scale` metres per length unit).
/// Points along edges are shared by the faces on both sides. Precondition: triangulate_faces.
Tessellation collect_triangles(const FaceEdges& topology, double scale);

}  // namespace flowcage::occ
