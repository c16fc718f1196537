#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/csr.hpp"
#include "core/mesh/cage.hpp"
#include "core/mesh/mirror_planes.hpp"

namespace flowcage {

/// Topology of one Catmull-Clark level: numbers only, the points live beside it as std::vector<Vec3> of size
/// #V.
///
/// Orientation: faces are counter-clockwise. Edge i of a face joins its corners i and i+1.
/// Rings: vertex_edges[v] and vertex_faces[v] go counter-clockwise round v; face i lies between edges i and
/// i+1 (cyclic). At a boundary vertex the first and last edge are the boundary edges, so there is one face
/// fewer than edges.
///
/// Children (build_child_level): vertices keep their number, then come the edge points (#V + e), then the
/// face points
/// (#V + #E + f). Child faces of face f are contiguous from face_vertices.offsets[f]; the i-th is
/// (corner i, edge point i, face point, edge point i-1), so its corner 0 is the parent's corner i.
struct SurfaceLevel {
  Csr<Index> face_vertices;  ///< #F rows
  Csr<Index> face_edges;     ///< #F rows, same shape
  std::vector<std::array<Index, 2>>
      edge_vertices;  ///< #E, smaller vertex first at level 0; parent vertex first below
  std::vector<std::array<Index, 2>> edge_faces;  ///< #E; the second is no_index on the boundary
  Csr<Index> vertex_edges;                       ///< #V rows
  Csr<Index> vertex_faces;                       ///< #V rows
  std::vector<double> edge_sharpness;            ///< #E; boundary edges are infinitely_sharp unless mirrored
  std::vector<double>
      vertex_sharpness;           ///< #V; a boundary vertex with one face is a corner (infinitely_sharp)
  std::vector<Index> face_patch;  ///< #F, inherited
  int depth = 0;                  ///< 0 for the cage
  MirrorPlanes mirrors;           ///< of half models (mirror.hpp)
  std::vector<std::int8_t>
      edge_mirror_axis;  ///< #E, empty without mirrors; the plane a boundary edge is mirrored at, or -1

  Index vertex_count() const { return vertex_edges.size(); }
  Index edge_count() const { return static_cast<Index>(edge_vertices.size()); }
  Index face_count() const { return face_vertices.size(); }
  bool is_boundary_edge(Index e) const { return edge_faces[e][1] == no_index; }
};

/// The topology of a cage; an edge or vertex tagged twice has the larger sharpness. Throws Error(input)
/// naming the place where the cage is no oriented manifold (manifold_check.hpp).
SurfaceLevel build_surface_level(const Cage& cage);

/// V - E + F, components and boundary loops; genus = (2 components - loops - euler) / 2.
struct Topology {
  Index euler = 0, components = 0, boundary_loops = 0, genus = 0;
};
Topology topology_of(const SurfaceLevel& level);

}  // namespace flowcage
