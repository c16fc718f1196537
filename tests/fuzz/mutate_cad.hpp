#pragma once
#include <cstdint>
#include <string>

namespace flowcage {

/// A damaged copy of a STEP or IGES text, the same for the same seed: by turns flipped bits, lines cut,
/// numbers made NaN, 1e308, zero or negative, pieces moved, and the end lost (its last lines kept, else
/// reading stops at the first look).
std::string mutated_cad(std::string text, std::uint32_t seed);

}  // namespace flowcage
