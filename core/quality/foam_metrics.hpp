#pragma once
#include <array>

#include "core/quality/jacobian.hpp"

namespace flowcage {

// OpenFOAM's own geometry and mesh metrics, as checkMesh of OpenFOAM v1912 computes them (primitiveMesh,
// primitiveMeshTools, polyMeshCheck; the formulas are given below, in the notation of its documentation).
// Lengths in metres, angles in degrees.

/// Centre and area vector (outward if the corners are counter-clockwise seen from outside) of a quad: it is
/// cut into four triangles at the mean of its corners; the area vector is the sum of theirs, the centre the
/// mean of their centres weighted with the triangles' areas.
struct FaceGeometry {
  Vec3 centre = Vec3::Zero();
  Vec3 area = Vec3::Zero();
};
FaceGeometry face_geometry(const std::array<Vec3, 4>& quad);

/// Volume and centre of a cell: it is cut into six pyramids at the mean of the face centres; a pyramid's
/// volume is area . (face centre - apex) / 3, its centre 3/4 face centre + 1/4 apex; the cell's centre is
/// their volume-weighted mean.
struct CellGeometry {
  Vec3 centre = Vec3::Zero();
  double volume = 0;
  Vec3 sum_area = Vec3::Zero();      ///< sum of the area vectors: zero if the cell is closed
  Vec3 sum_mag_area = Vec3::Zero();  ///< sum of their absolute components
};
CellGeometry cell_geometry(const HexCorners& hex);

/// Largest component of |sum of area vectors| / sum of |area vectors|. 0 if closed; checkMesh fails above
/// 1e-6.
double cell_openness(const CellGeometry& cell);

/// The larger of: the ratio of the largest to the least component of sum |area vectors|, and
/// (sum of those components) / 6 / volume^(2/3). 1 for a cube; checkMesh fails above 1000.
/// It depends on the axes: a slender cell along a diagonal has a smaller figure than one along an axis.
double cell_aspect_ratio(const CellGeometry& cell);

/// Cosine of the angle between a face's area vector and the line from the owner's to the neighbour's centre:
/// 1 if orthogonal, not positive at 90 degrees and more (checkMesh fails). Inner faces only.
double face_orthogonality(const Vec3& area, const Vec3& owner_centre, const Vec3& neighbour_centre);

/// |s| / max(0.2 |d|, reach of the face along s), where d joins the two cell centres and s goes from d's
/// crossing with the face's plane to the face's centre. 0 if they coincide; checkMesh fails above 4.
/// `face` is face_geometry(quad), `centres` those of owner and neighbour.
double face_skewness(const std::array<Vec3, 4>& quad, const FaceGeometry& face,
                     const std::array<Vec3, 2>& centres);

/// The same on the boundary: d is the part of (face centre - cell centre) along the face's normal, with
/// factor 0.4.
double boundary_face_skewness(const std::array<Vec3, 4>& quad, const FaceGeometry& face,
                              const Vec3& owner_centre);

}  // namespace flowcage
