#include "core/mesh/opening_names.hpp"

#include <algorithm>
#include <cctype>
#include <string>

namespace flowcage {

PatchType patch_type_of_name(std::string_view name) {
  std::string word(name);
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  while (!word.empty() && std::isdigit(static_cast<unsigned char>(word.back())) != 0) word.pop_back();
  if (!word.empty() && std::string_view(" _-").find(word.back()) != std::string_view::npos &&
      word.size() < name.size()) {
    word.pop_back();
  }
  if (word == "inlet" || word == "inflow") return PatchType::inlet;
  if (word == "outlet" || word == "outflow") return PatchType::outlet;
  return PatchType::wall;
}

void name_openings(BlockMesh& mesh) {
  for (std::size_t p = 0; p < mesh.patches().size(); ++p) {
    if (mesh.patches()[p].type != PatchType::wall) continue;
    mesh.set_patch_type(p, patch_type_of_name(mesh.patches()[p].name));
  }
}

}  // namespace flowcage
