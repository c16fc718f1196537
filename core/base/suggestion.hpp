#pragma once
#include <string>
#include <vector>

namespace flowcage {

/// The candidate that a mistyped word most likely means; empty if none is near. Near: at most a third of its
/// letters changed (insertions, deletions, replacements, swapped neighbours), or the beginning of it.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace flowcage
