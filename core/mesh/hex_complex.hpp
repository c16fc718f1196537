#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// The coarse blocks: a conforming complex of hexes with its edges and quads drawn once. Every source of
/// blocks (two polyhedra, automatic, a user's block file) makes one of these; everything after it is the same
/// code.
struct HexComplex {
  struct Patch {
    std::string name;
    PatchType type = PatchType::wall;
  };

  std::vector<Vec3> points;                 ///< #corners
  std::vector<HexPoints> hexes;             ///< #H, VTK order, right-handed
  std::vector<std::array<Index, 2>> edges;  ///< #E
  std::vector<std::array<Index, 4>>
      quads;  ///< #Q, cyclic; boundary quads counter-clockwise seen from outside of the fluid
  std::vector<std::array<Index, 12>> hex_edges;  ///< #H, order of mesh/hex_numbering
  std::vector<std::array<Index, 6>> hex_quads;   ///< #H, order of hex_faces
  std::vector<std::array<Index, 2>> quad_hexes;  ///< #Q; the second is no_index on the boundary
  std::vector<Index> quad_patch;                 ///< #Q; no_index inside
  std::vector<Patch> patches;
  std::vector<double> edge_sharpness;    ///< #E; creases of the 2-D boundary surface; 0 elsewhere
  std::vector<double> corner_sharpness;  ///< #corners
  std::vector<Index> edge_chord;         ///< #E; edges opposite in a quad share a chord
  Index chord_count = 0;
};

/// What the caller knows of a boundary quad; `corners` in any rotation or orientation.
struct BoundaryQuad {
  std::array<Index, 4> corners{};
  Index patch = 0;
};
struct SharpEdge {
  Index a = no_index, b = no_index;
  double sharpness = infinitely_sharp;
};

/// Builds edges, quads, adjacency and chords. Edges where two boundary quads of different patches meet are
/// infinitely sharp (the boundary is a 2-D Catmull-Clark surface with creases there; docs/theory.md),
/// `sharp` adds others. Throws Error(input) naming the place: a quad with more than two hexes, a boundary
/// quad in no or two hexes or without patch, a non-manifold boundary, a hex with a repeated corner.
HexComplex build_hex_complex(std::vector<Vec3> points, std::vector<HexPoints> hexes,
                             std::vector<HexComplex::Patch> patches,
                             const std::vector<BoundaryQuad>& boundary, const std::vector<SharpEdge>& sharp);

}  // namespace flowcage
