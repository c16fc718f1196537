#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/blocks/outer_shape.hpp"
#include "core/blocks/wall_blocks.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

/// Inner and outer surface joined by edges and faces: one block a quad of the inner surface (Rom & Brakhage
/// 2011, section 5).
///
/// Block f stands on face f of `inner`: its corners 0-3 are that face's vertices, 4-7 those of the outer
/// face, so i runs along the face's first side, j along its last, k from the wall (0) to the outer boundary.
/// Corner v of the complex is inner vertex v, corner #V + v the outer one. All k-edges are one chord,
/// `k_chord`.
///
/// Patches: the cage's own names ("wall" where it has none), "farfield", and "symmetry" over the edges of an
/// open boundary. Sharp: creases and corners of both polyhedra, and the borders of farfield and symmetry;
/// between walls only what the cage says, because the fitted surface is smooth there.
struct Shell : WallBlocks {
  SurfaceLevel outer;                           ///< numbered as `wall`, with its own sharpness
  std::vector<Vec3> wall_points, outer_points;  ///< #V
  Index k_chord = no_index;
  std::optional<OuterShape> outer_shape;  ///< of a grown far field (blocks/farfield)
  bool box_edges_sharp = false;           ///< a box far field whose edges are edges of the mesh
};

/// The shell between a cage and an outer polyhedron of the same topology in any vertex numbering (blocks/
/// match_polyhedra finds which vertex belongs to which; the outer polyhedron's creases are its own and need
/// not agree). Both may be oriented either way round the fluid; the cage must be right side out. With n-gons
/// both are subdivided once. An open cage is a half model: its boundary lies in a plane, the outer
/// polyhedron's in the same.
/// Throws Error(input) with the two names and numbers: no manifold, different topology, no isomorphism, an
/// outer polyhedron that does not enclose the cage, a boundary that is not planar.
Shell build_shell(const Cage& inner, const Cage& outer);

/// The lower half of build_shell, for other outer surfaces: `outer_points` has one place a vertex of `inner`
/// (quads only), `outer_sharpness` one value an edge (empty: smooth), `outer_corners` one a vertex.
struct ShellParts {
  SurfaceLevel inner;
  std::vector<Vec3> inner_points, outer_points;
  std::vector<double> outer_edge_sharpness, outer_vertex_sharpness;  ///< empty: smooth
  std::vector<std::string> patch_names;                              ///< of inner.face_patch
  std::optional<SymmetryPlane> symmetry;
  int cage_level = 0;
  std::string source;  ///< the cage's, for messages
};
Shell join(ShellParts parts);

/// The inner side of a shell: checked, right side out, its boundary exactly in the plane; the cage itself.
ShellParts prepare_inner(const Cage& cage);

/// Subdivides the inner side once where the cage has faces that are no quads.
void make_quads(ShellParts& parts);

/// The block mesh of a shell before any refinement: `layers` cells from wall to outer boundary on straight
/// lines, evenly spaced. `inner_points` replace the shell's own (the fitted control points of level
/// shell.cage_level; pass shell.wall_points otherwise).
BlockMesh start_volume(const Shell& shell, std::span<const Vec3> inner_points, Index layers = 1);

}  // namespace flowcage
