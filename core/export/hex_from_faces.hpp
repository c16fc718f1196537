#pragma once
#include <array>
#include <optional>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// A hex from its six quads, in any order and rotation, each counter-clockwise seen from outside: the first
/// becomes the bottom (corners 0, 3, 2, 1). Nothing if they do not close to a hex with outward faces.
std::optional<HexPoints> hex_from_faces(const std::array<std::array<Index, 4>, 6>& faces);

}  // namespace flowcage
