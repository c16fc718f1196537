#pragma once
#include "core/blocks/shell.hpp"

namespace flowcage {

/// The far field that grows from the body where no outer polyhedron is drawn.
struct FarField {
  OuterShape::Kind kind = OuterShape::Kind::box;
  /// Distance from the body's centre to the outer boundary (sphere: radius, box: half its edge) in body
  /// lengths; one body length is the largest extent of the body's bounding box.
  double body_lengths = 20;
};

/// A shell from a cage to a sphere, box or bullet. The cage's faces are carried to the sphere by a fold-free
/// map (blocks/spherical_embedding), to the others by projection from the centre, of a box, with the box's
/// edges on edges of the mesh where the cage's connectivity allows it (blocks/box_edges);
/// Shell::box_edges_sharp tells. `body` is the bounding box of the CAD (or of the cage, where that is empty);
/// a half model's far field is cut by the symmetry plane. Throws Error(input) as build_shell does, and when
/// the cage's genus is not 0 (an outer polyhedron of the same genus is needed), or its map folds;
/// Error(usage) when the size does not clear the body.
Shell build_farfield_shell(const Cage& cage, const FarField& settings, const Box3& body);

/// Control points of the outer surface after `depth` refinements of the shell's outer level, in the numbering
/// of the surface levels; with an outer shape exactly on it. With `limit` the limit points of an outer
/// polyhedron instead.
std::vector<Vec3> outer_points(const Shell& shell, int depth, bool limit);

/// Puts the points at the outer ends of a mesh's lines on the shell's outer shape, where it has one.
void project_outer(BlockMesh& mesh, const Shell& shell);

}  // namespace flowcage
