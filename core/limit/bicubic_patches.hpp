#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/surface_level.hpp"
#include "core/target/bspline_patch.hpp"

namespace flowcage {

/// A limit surface as few bicubic B-spline patches with the topology of a boundary representation.

/// A piece of a patch's side, as long as one patch or nothing lies beyond it. Sides go counter-clockwise:
/// 0 along u at v = 0, 1 along v at the last u, 2 back along u at the last v, 3 back along v at u = 0.
/// `from` < `to` are the parameters (u or v) of its ends.
struct PatchSide {
  Index patch = 0;
  int side = 0;
  double from = 0, to = 0;
};

/// A curve between two nodes. uses[0] goes counter-clockwise round its patch from nodes[0] to nodes[1],
/// uses[1] the other way. The two are the same curve up to rounding, and their parameters differ by a shift
/// or a reflection.
struct PatchEdge {
  std::array<Index, 2> nodes{no_index, no_index};
  std::array<PatchSide, 2> uses;
  int use_count = 0;    ///< 1: open boundary
  bool crease = false;  ///< the surface need not be smooth across it
};

struct PatchBoundary {
  Index edge = 0;
  bool forward = true;  ///< from nodes[0] to nodes[1]
};

struct BicubicPatch {
  BSplineSurface surface;  ///< u x v toward the side from which the level's faces are counter-clockwise
  std::vector<PatchBoundary> boundary;  ///< counter-clockwise from (0,0)
  Index name = 0;                       ///< face_patch
};

struct PatchSurface {
  std::vector<Vec3> nodes;  ///< where patches end; one may lie within a side of a third patch
  std::vector<PatchEdge> edges;
  std::vector<BicubicPatch> patches;
  double max_deviation = 0;  ///< largest distance from the limit surface at samples, metres
  /// Largest angle of two patches' normals along an edge that is no crease, but for corners without a tangent
  /// plane, whose cells are left out.
  double max_angle_degrees = 0;
  Vec3 worst_angle_place = Vec3::Zero();
};

struct PatchSettings {
  double max_angle_degrees = 0.03;  ///< aimed at near irregular vertices
  double max_deviation = 1e-7;      ///< there, relative to the diagonal of the control points' box
};

/// Over a regular quad a limit surface of Catmull and Clark is a uniform bicubic B-spline, so over a
/// rectangular block of quads (quad_blocks.hpp) it is one B-spline surface, exactly: knots are counted in
/// quads. Next to an irregular vertex it consists of infinitely many bicubic rings of sizes 1/2, 1/4, ...
/// (Stam 1998). Here knots at these places continue the exact surface to the ring 2^-depth; the corner cell
/// that is left is replaced (corner_cells.hpp), joined C1 by a double knot, so that every patch is C1, and C2
/// but for the lines of these knots. Patches that meet have the same boundary curve; their tangent planes
/// agree exactly, but within corner cells only up to `max_angle_degrees`.
///
/// n-gons, semi-sharp features and quads too coarse for blocks are refined first. Throws Error(usage) if that
/// takes more than 3e7 quads. Precondition: points.size() == level.vertex_count().
PatchSurface make_bicubic_patches(SurfaceLevel level, std::vector<Vec3> points, const PatchSettings& settings,
                                  Progress& progress);

}  // namespace flowcage
