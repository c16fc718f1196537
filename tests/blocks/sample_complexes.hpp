// Block complexes that tests of blocks, volume and optimise share.
#pragma once
#include <map>
#include <random>

#include "core/base/error.hpp"
#include "core/mesh/hex_complex.hpp"

namespace flowcage::sample {

/// The message of the Error that `f` throws; "" if it throws none.
template <typename F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::array<Index, 4> face_of_hex(const HexPoints& hex, int face) {
  const auto& f = hex_faces[face];
  return {hex[f[0]], hex[f[1]], hex[f[2]], hex[f[3]]};
}

/// Faces that occur once, all in patch 0 ("wall").
inline HexComplex with_one_patch(const std::vector<Vec3>& points, const std::vector<HexPoints>& hexes,
                                 const std::vector<SharpEdge>& sharp = {}) {
  std::map<std::array<Index, 4>, int> uses;
  const auto key = [](std::array<Index, 4> q) {
    std::sort(q.begin(), q.end());
    return q;
  };
  for (const HexPoints& h : hexes) {
    for (int f = 0; f < 6; ++f) ++uses[key(face_of_hex(h, f))];
  }
  std::vector<BoundaryQuad> boundary;
  for (const auto& [q, count] : uses) {
    if (count == 1) boundary.push_back({q, 0});
  }
  return build_hex_complex(points, hexes, {{"wall", PatchType::wall}}, boundary, sharp);
}

/// n[0] x n[1] x n[2] unit blocks; six patches i-min .. k-max.
inline HexComplex grid_complex(std::array<Index, 3> n) {
  std::vector<Vec3> points;
  for (Index k = 0; k <= n[2]; ++k) {
    for (Index j = 0; j <= n[1]; ++j) {
      for (Index i = 0; i <= n[0]; ++i) points.emplace_back(i, j, k);
    }
  }
  const auto at = [&](Index i, Index j, Index k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
  std::vector<HexPoints> hexes;
  std::vector<BoundaryQuad> boundary;
  for (Index k = 0; k < n[2]; ++k) {
    for (Index j = 0; j < n[1]; ++j) {
      for (Index i = 0; i < n[0]; ++i) {
        hexes.push_back({at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
                         at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
        const std::array<Index, 3> cell{i, j, k};
        for (int f = 0; f < 6; ++f) {
          if (cell[f / 2] == (f % 2 == 0 ? 0 : n[f / 2] - 1)) {
            boundary.push_back({face_of_hex(hexes.back(), f), f});
          }
        }
      }
    }
  }
  return build_hex_complex(points, hexes,
                           {{"imin", PatchType::wall},
                            {"imax", PatchType::wall},
                            {"jmin", PatchType::wall},
                            {"jmax", PatchType::wall},
                            {"kmin", PatchType::wall},
                            {"kmax", PatchType::wall}},
                           boundary, {});
}

inline std::vector<BoundaryQuad> boundary_of(const HexComplex& c) {
  std::vector<BoundaryQuad> boundary;
  for (std::size_t q = 0; q < c.quads.size(); ++q) {
    if (c.quad_patch[q] != no_index) boundary.push_back({c.quads[q], c.quad_patch[q]});
  }
  return boundary;
}

/// A hex seen in another of its 24 right-handed orientations.
inline HexPoints turned(HexPoints h, std::mt19937& random) {
  for (auto n = random() % 6; n > 0; --n) {
    h = random() % 2 == 0 ? HexPoints{h[1], h[2], h[3], h[0], h[5], h[6], h[7], h[4]}   // about k
                          : HexPoints{h[4], h[5], h[1], h[0], h[7], h[6], h[2], h[3]};  // about i
  }
  return h;
}

/// A connected part of a grid, extruded rings of 3 or 5 quads included, with every block turned at random and
/// the corners renumbered: edges and quads occur in all orientations, edges with 3 and 5 blocks occur.
inline HexComplex random_complex(std::mt19937& random) {
  std::vector<Vec3> points;
  std::vector<HexPoints> hexes;
  if (random() % 2 == 0) {
    const HexComplex grid = grid_complex({2, 2, 2});
    points = grid.points;
    hexes = grid.hexes;
  } else {  // n kites round an axis, two layers high
    const int n = 3 + 2 * static_cast<int>(random() % 2);
    const int ring = 2 * n + 1;
    for (int layer = 0; layer < 3; ++layer) {
      points.emplace_back(0.013, 0.007, layer);
      for (int s = 0; s < 2 * n; ++s) {
        const double angle = 3.14159265358979 * s / n;
        points.emplace_back(std::cos(angle), std::sin(angle), layer + 0.1 * s / n);
      }
    }
    for (int layer = 0; layer < 2; ++layer) {
      for (int s = 0; s < n; ++s) {
        HexPoints h{};
        const int corners[4] = {0, 1 + 2 * s, 2 + 2 * s, 1 + (2 * s + 2) % (2 * n)};
        for (int c = 0; c < 4; ++c) {
          h[c] = ring * layer + corners[c];
          h[c + 4] = h[c] + ring;
        }
        hexes.push_back(h);
      }
    }
  }
  std::vector<Index> renumber(points.size());
  for (std::size_t v = 0; v < renumber.size(); ++v) renumber[v] = static_cast<Index>(v);
  std::shuffle(renumber.begin(), renumber.end(), random);
  std::vector<Vec3> shuffled(points.size());
  for (std::size_t v = 0; v < points.size(); ++v) shuffled[renumber[v]] = points[v];
  for (HexPoints& h : hexes) {
    for (Index& v : h) v = renumber[v];
    h = turned(h, random);
  }
  std::shuffle(hexes.begin(), hexes.end(), random);
  return with_one_patch(shuffled, hexes);
}

}  // namespace flowcage::sample
