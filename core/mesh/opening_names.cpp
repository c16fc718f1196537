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

}  // namespace flowcage
