#pragma once
#include <vector>

#include "core/base/csr.hpp"
#include "core/mesh/hex_complex.hpp"

namespace flowcage {

/// What meets at the edges and corners of a complex: the neighbourhoods that the refinement rules gather.
struct ComplexIncidence {
  struct Slot {
    Index element;  ///< hex or quad
    int place;      ///< which of its edges (mesh/hex_numbering; sides 0-3 of a quad) or corners
  };
  Csr<Slot> edge_hexes;           ///< #E, ascending hexes
  Csr<Slot> corner_hexes;         ///< #corners
  Csr<Slot> edge_boundary_quads;  ///< #E: none inside, two on the boundary
  Csr<Slot> corner_boundary_quads;
  Csr<Index> corner_boundary_edges;
};

ComplexIncidence incidence_of(const HexComplex& complex);

}  // namespace flowcage
