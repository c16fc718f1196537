#include "core/export/hex_from_faces.hpp"

#include <algorithm>

namespace flowcage {

std::optional<HexPoints> hex_from_faces(const std::array<std::array<Index, 4>, 6>& faces) {
  const auto& bottom = faces[0];
  HexPoints hex;
  hex.fill(no_index);
  for (int i = 0; i < 4; ++i) hex[i] = bottom[(4 - i) % 4];
  const auto corner_of = [&](Index p) { return std::find(hex.begin(), hex.begin() + 4, p) - hex.begin(); };

  // The side on the bottom's edge runs along it the other way, then up: hex[c], hex[c+1], above c+1, above c.
  std::array<bool, 4> has_side{};
  const std::array<Index, 4>* top = nullptr;
  for (int f = 1; f < 6; ++f) {
    const auto& face = faces[f];
    const auto shared = std::count_if(face.begin(), face.end(), [&](Index p) { return corner_of(p) < 4; });
    if (shared == 0 && !top) {
      top = &face;
      continue;
    }
    bool found = false;
    for (int i = 0; i < 4 && shared == 2; ++i) {
      const auto c = corner_of(face[i]), next = (c + 1) % 4;
      if (c == 4 || face[(i + 1) % 4] != hex[next] || has_side[c]) continue;
      const Index above_next = face[(i + 2) % 4], above = face[(i + 3) % 4];
      for (const auto& [slot, point] : {std::pair{4 + next, above_next}, std::pair{4 + c, above}}) {
        if (hex[slot] != no_index && hex[slot] != point) return {};
        hex[slot] = point;
      }
      found = has_side[c] = true;
    }
    if (!found) return {};
  }
  if (!top) return {};  // five faces left, so four sides, all different
  HexPoints sorted = hex;
  std::sort(sorted.begin(), sorted.end());
  if (sorted[0] == no_index || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return {};
  // The top runs as the hex's upper corners do.
  const auto first = std::find(top->begin(), top->end(), hex[4]) - top->begin();
  for (int i = 0; i < 4; ++i) {
    if (first == 4 || (*top)[(first + i) % 4] != hex[4 + i]) return {};
  }
  return hex;
}

}  // namespace flowcage
