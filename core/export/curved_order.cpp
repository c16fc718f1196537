#include "core/export/curved_order.hpp"

#include <array>

#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

using Place = std::array<int, 2>;  ///< (u, v) in a square of n x n nodes
using Corners = std::array<int, 4>;

std::vector<Place> rows(int n) {
  std::vector<Place> out(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) out[u + n * v] = {u, v};
  }
  return out;
}

/// Rings from outside in, each from its first corner on, first along u.
std::vector<Place> spiral(int n) {
  if (n <= 0) return {};
  if (n == 1) return {{0, 0}};
  std::vector<Place> out;
  out.reserve(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  const int last = n - 1;
  for (int a = 0; a < last; ++a) out.push_back({a, 0});
  for (int a = 0; a < last; ++a) out.push_back({last, a});
  for (int a = last; a > 0; --a) out.push_back({a, last});
  for (int a = last; a > 0; --a) out.push_back({0, a});
  for (const auto& [u, v] : spiral(n - 2)) out.push_back({u + 1, v + 1});
  return out;
}

/// Corners, edges in a circle, and inside the same again.
std::vector<Place> nested(int n) {
  if (n <= 0) return {};
  if (n == 1) return {{0, 0}};
  const int last = n - 1;
  std::vector<Place> out{{0, 0}, {last, 0}, {last, last}, {0, last}};
  for (int a = 1; a < last; ++a) out.push_back({a, 0});
  for (int a = 1; a < last; ++a) out.push_back({last, a});
  for (int a = last - 1; a > 0; --a) out.push_back({a, last});
  for (int a = last - 1; a > 0; --a) out.push_back({0, a});
  for (const auto& [u, v] : nested(n - 2)) out.push_back({u + 1, v + 1});
  return out;
}

using Ijk = std::array<int, 3>;

class HexOrder {
 public:
  explicit HexOrder(int order) : p_(order) {}

  void corners() {
    for (int c = 0; c < 8; ++c) add(corner(c));
  }
  void edge(int from, int to) {
    for (int a = 1; a < p_; ++a) add(between(corner(from), corner(to), a));
  }
  /// The inside of a face: u from the first corner to the second, v to the fourth.
  void face(const Corners& c, const std::vector<Place>& places) {
    for (const auto& [u, v] : places) {
      const Ijk along = between(corner(c[0]), corner(c[1]), u + 1),
                up = between(corner(c[0]), corner(c[3]), v + 1);
      Ijk at{};
      for (int d = 0; d < 3; ++d) at[d] = along[d] + up[d] - corner(c[0])[d];
      add(at);
    }
  }
  void add(const Ijk& at) { out_.push_back(at[0] + (p_ + 1) * (at[1] + (p_ + 1) * at[2])); }
  std::vector<int> take() { return std::move(out_); }

 private:
  Ijk corner(int c) const {
    return {p_ * hex_corner_ijk[c][0], p_ * hex_corner_ijk[c][1], p_ * hex_corner_ijk[c][2]};
  }
  Ijk between(const Ijk& from, const Ijk& to, int steps) const {
    Ijk at{};
    for (int d = 0; d < 3; ++d) at[d] = from[d] + (to[d] - from[d]) / p_ * steps;
    return at;
  }
  int p_;
  std::vector<int> out_;
};

std::vector<int> quad_of(const std::vector<Place>& places, int order) {
  std::vector<int> out;
  out.reserve(places.size());
  for (const auto& [u, v] : places) out.push_back(u + (order + 1) * v);
  return out;
}

/// Gmsh's hex of n nodes along an edge, as places in the lattice of that hex.
std::vector<Ijk> nested_hex(int n) {
  if (n <= 0) return {};
  if (n == 1) return {{0, 0, 0}};
  constexpr std::array<std::array<int, 2>, 12> edges{
      {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};
  constexpr std::array<Corners, 6> faces{
      {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}}};
  HexOrder order(n - 1);
  order.corners();
  for (const auto& [from, to] : edges) order.edge(from, to);
  for (const Corners& face : faces) order.face(face, nested(n - 2));
  std::vector<Ijk> out;
  for (const int at : order.take()) out.push_back({at % n, at / n % n, at / n / n});
  for (const auto& [i, j, k] : nested_hex(n - 2)) out.push_back({i + 1, j + 1, k + 1});
  return out;
}

}  // namespace

CurvedOrder vtk_order(int order) {
  HexOrder hex(order);
  hex.corners();
  for (const int edge : hex_edge_of_vtk) hex.edge(hex_edges[edge][0], hex_edges[edge][1]);
  constexpr std::array<Corners, 6> faces{
      // lower axis along u
      {{0, 3, 7, 4}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 2, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}}};
  for (const Corners& face : faces) hex.face(face, rows(order - 1));
  for (int k = 1; k < order; ++k) {
    for (const auto& [i, j] : rows(order - 1)) hex.add({i + 1, j + 1, k});
  }
  std::vector<Place> quad{{0, 0}, {order, 0}, {order, order}, {0, order}};
  for (int a = 1; a < order; ++a) quad.push_back({a, 0});
  for (int a = 1; a < order; ++a) quad.push_back({order, a});
  for (int a = 1; a < order; ++a) quad.push_back({a, order});
  for (int a = 1; a < order; ++a) quad.push_back({0, a});
  for (const auto& [u, v] : rows(order - 1)) quad.push_back({u + 1, v + 1});
  return {hex.take(), quad_of(quad, order)};
}

CurvedOrder gmsh_order(int order) {
  HexOrder hex(order);
  for (const Ijk& at : nested_hex(order + 1)) hex.add(at);
  return {hex.take(), quad_of(nested(order + 1), order)};
}

CurvedOrder cgns_order(int order) {
  HexOrder hex(order);
  hex.corners();
  constexpr std::array<std::array<int, 2>, 12> edges{
      {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}}};
  constexpr std::array<Corners, 6> faces{
      {{0, 1, 2, 3}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}}};
  for (const auto& [from, to] : edges) hex.edge(from, to);
  for (const Corners& face : faces) hex.face(face, spiral(order - 1));
  for (int k = 1; k < order; ++k) {
    for (const auto& [i, j] : spiral(order - 1)) hex.add({i + 1, j + 1, k});
  }
  // Corners and edges of a quad are those of `nested`, inside it is a spiral.
  std::vector<Place> quad = nested(order + 1);
  quad.resize(4 * static_cast<std::size_t>(order));
  for (const auto& [u, v] : spiral(order - 1)) quad.push_back({u + 1, v + 1});
  return {hex.take(), quad_of(quad, order)};
}

}  // namespace flowcage
