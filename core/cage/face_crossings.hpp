#pragma once
#include <utility>
#include <vector>

#include "core/cage/lint_report.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

/// A pair of faces that pass through each other, and a point of both.
struct FaceCrossing {
  Index a = no_index, b = no_index;  ///< a < b
  Vec3 place = Vec3::Zero();
};

/// All pairs of faces without a common vertex that cross, ordered. Faces are fans of triangles round their
/// centre; an end of an edge that only touches a face is no crossing. Precondition: finite points.
std::vector<FaceCrossing> find_face_crossings(const Cage& cage);

/// Rule "self_crossing", a warning: the limit surface of such a cage passes through itself, too, unless the
/// fit pulls the parts apart, and no volume lies between them.
LintReport lint_face_crossings(const Cage& cage);

}  // namespace flowcage
