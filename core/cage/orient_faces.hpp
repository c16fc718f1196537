#pragma once
#include <optional>
#include <vector>

#include "core/mesh/cage.hpp"

namespace flowcage {

/// The faces to reverse so that neighbours run along their common edge in opposite directions: in each
/// connected part the fewer ones (as many on both sides: not those that agree with its first face); in
/// ascending order. Nothing if that is impossible: a Moebius strip, or an edge with more than two faces.
/// Any indices are safe to pass.
std::optional<std::vector<Index>> faces_to_reverse(const Csr<Index>& faces);

/// Reverses these faces; each keeps its first vertex.
void reverse_faces(std::span<const Index> which, Csr<Index>& faces);

}  // namespace flowcage
