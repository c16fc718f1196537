#include "core/export/patch_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace flowcage {
namespace {

constexpr std::size_t longest = 32;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

std::string legal_form(const std::string& name) {
  std::string legal;
  for (const char c : name) {
    const bool keep = is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    legal += keep ? c : '_';
  }
  if (legal.empty()) return "patch";
  if (!is_letter(legal[0])) legal.insert(0, "patch_");
  return legal.substr(0, longest);
}

}  // namespace

PatchNames legal_patch_names(const std::vector<std::string>& names) {
  PatchNames result;
  result.names.resize(names.size());
  std::set<std::string> taken;
  // Names that are legal as they are keep their name, whatever the order.
  std::vector<char> done(names.size(), 0);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (legal_form(names[i]) == names[i] && taken.insert(names[i]).second) {
      result.names[i] = names[i];
      done[i] = 1;
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (done[i]) continue;
    const std::string base = legal_form(names[i]);
    std::string name = base;
    for (int n = 2; !taken.insert(name).second; ++n) {
      const std::string suffix = fmt::format("_{}", n);
      name = base.substr(0, longest - suffix.size()) + suffix;
    }
    result.names[i] = name;
    result.notes.push_back(fmt::format("patch \"{}\" is written as \"{}\"", names[i], name));
  }
  return result;
}

PatchNames legal_patch_names(const HexView& mesh) {
  std::vector<std::string> given;
  for (const BoundaryPatch& patch : mesh.patches()) given.push_back(patch.name);
  return legal_patch_names(given);
}

PatchType foreign_patch_type(const std::string& name) {
  std::string lower = name;
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  const auto has = [&lower](const char* part) { return lower.find(part) != std::string::npos; };
  if (has("far")) return PatchType::farfield;
  if (has("sym")) return PatchType::symmetry;
  if (has("inlet") || has("inflow")) return PatchType::inlet;
  if (has("outlet") || has("outflow")) return PatchType::outlet;
  return PatchType::wall;
}

}  // namespace flowcage
