#pragma once
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "occ_bridge/internal/read_files.hpp"

namespace flowcage::occ {

struct SewSettings {
  std::vector<double> tolerances{1e-6, 1e-5, 1e-4};  ///< relative to the diagonal, ascending
  double diagonal = 1;                               ///< in the shape's length unit
};

/// A model whose shells are as closed as sewing makes them.
struct SewnShape {
  TopoDS_Shape shape;    ///< compound of solids, open shells and single faces
  double tolerance = 0;  ///< that the sewing used, in the shape's length unit; 0: not sewn
  Index free_edges_before = 0, free_edges = 0;
};

/// Sews what is open: loose faces and shells with free edges (closed solids and shells stay as they are).
/// Tolerances are tried in their order until nothing is free; the result with the fewest free edges is kept,
/// the unsewn one where sewing gains nothing. Every closed shell becomes a solid. Shells whose faces do not
/// agree on a side are made consistent; an open shell keeps the side that most of its faces had in the file.
SewnShape sew_open_parts(const TopoDS_Shape& shape, const SewSettings& settings, FaceLabels& labels,
                         std::vector<std::string>& warnings, Progress& progress);

/// Turns solids that are inside out. Precondition: the shape is tessellated (the sign of the tessellation's
/// volume decides).
TopoDS_Shape orient_outward(const TopoDS_Shape& shape);

/// Leaves out the faces that are narrower than `width` on average: strips collapsed to a curve, which some
/// systems write at tips and sharp trailing edges. They have no normal, and sewing joins what is beside them.
TopoDS_Shape without_slivers(const TopoDS_Shape& shape, double width, const FaceLabels& labels,
                             std::vector<std::string>& warnings);

}  // namespace flowcage::occ
