#include "core/cage/orient_faces.hpp"

#include <algorithm>
#include <tuple>

namespace flowcage {
namespace {

struct Side {
  Index low, high;
  Index face;
  bool ascending;
};

}  // namespace

std::optional<std::vector<Index>> faces_to_reverse(const Csr<Index>& faces) {
  std::vector<Side> sides;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Index a = face[i], b = face[(i + 1) % face.size()];
      sides.push_back({std::min(a, b), std::max(a, b), f, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  struct Neighbour {
    Index face;
    bool same_way;
  };
  std::vector<std::vector<Neighbour>> neighbours(static_cast<std::size_t>(faces.size()));
  for (std::size_t k = 0; k < sides.size();) {
    std::size_t end = k + 1;
    while (end < sides.size() && sides[end].low == sides[k].low && sides[end].high == sides[k].high) ++end;
    if (end - k > 2) return std::nullopt;
    if (end - k == 2) {
      const bool same_way = sides[k].ascending == sides[k + 1].ascending;
      neighbours[sides[k].face].push_back({sides[k + 1].face, same_way});
      neighbours[sides[k + 1].face].push_back({sides[k].face, same_way});
    }
    k = end;
  }
  enum : char { unknown, kept, turned };
  std::vector<char> state(neighbours.size(), unknown);
  std::vector<Index> reversed;
  for (Index seed = 0; seed < faces.size(); ++seed) {
    if (state[seed] != unknown) continue;
    std::vector<Index> part{seed};
    state[seed] = kept;
    for (std::size_t k = 0; k < part.size(); ++k) {
      for (const Neighbour& n : neighbours[part[k]]) {
        const char wanted = n.same_way == (state[part[k]] == kept) ? turned : kept;
        if (state[n.face] == unknown) {
          state[n.face] = wanted;
          part.push_back(n.face);
        } else if (state[n.face] != wanted) {
          return std::nullopt;
        }
      }
    }
    const auto turned_count =
        std::count_if(part.begin(), part.end(), [&](Index f) { return state[f] == turned; });
    const char fewer = 2 * turned_count <= static_cast<Offset>(part.size()) ? turned : kept;
    for (const Index f : part) {
      if (state[f] == fewer) reversed.push_back(f);
    }
  }
  std::sort(reversed.begin(), reversed.end());
  return reversed;
}

void reverse_faces(std::span<const Index> which, Csr<Index>& faces) {
  for (const Index f : which) std::reverse(faces[f].begin() + 1, faces[f].end());
}

}  // namespace flowcage
