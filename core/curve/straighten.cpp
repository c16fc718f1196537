#include "core/curve/straighten.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/base/parallel.hpp"
#include "core/curve/curved_bound.hpp"

namespace flowcage {
namespace {

constexpr std::array<double, 4> shares{0.5, 0.25, 0.125, 0};  // of the way from straight to curved, by rounds
constexpr int most_rounds = 24;  // a cell may become invalid when its neighbour is straightened
constexpr Offset grain = 256;

/// Those of the cells for which test(cell, its nodes) holds, in their order.
template <typename Test>
std::vector<Offset> filtered(const CurvedMesh& mesh, const std::vector<Offset>& cells, const Test& test) {
  using Cells = std::vector<Offset>;
  return parallel_reduce(
      static_cast<Offset>(cells.size()), grain, Cells{},
      [&](Offset begin, Offset end) {
        Cells found;
        std::vector<Index> nodes(static_cast<std::size_t>(mesh.nodes_per_cell()));
        for (Offset i = begin; i < end; ++i) {
          mesh.read_cell(cells[i], nodes);
          if (test(nodes)) found.push_back(cells[i]);
        }
        return found;
      },
      [](Cells all, const Cells& part) {
        all.insert(all.end(), part.begin(), part.end());
        return all;
      });
}

}  // namespace

Offset straighten_cells(CurvedMesh& mesh, std::span<const Vec3> straight) {
  const std::vector<Vec3> curved(mesh.nodes.points().begin(), mesh.nodes.points().end());
  auto& points = mesh.nodes.mutable_points();
  std::vector<std::uint8_t> rounds(curved.size(), 0);  // how often a node was moved
  std::vector<Offset> suspects(static_cast<std::size_t>(mesh.cell_count()));
  std::iota(suspects.begin(), suspects.end(), Offset{0});
  std::vector<char> is_bad(static_cast<std::size_t>(mesh.cell_count()), 0);
  std::vector<Vec3> best;  // places with the fewest invalid cells so far
  Offset first = 0, fewest = 0;
  for (int round = 0; round <= most_rounds; ++round) {
    const std::vector<Offset> bad = filtered(mesh, suspects, [&](const std::vector<Index>& nodes) {
      std::vector<Vec3> places;
      places.reserve(nodes.size());
      for (const Index n : nodes) places.push_back(points[n]);
      return curved_jacobian_sign(places, mesh.order) != JacobianSign::positive;
    });
    for (const Offset cell : suspects) is_bad[cell] = 0;
    for (const Offset cell : bad) is_bad[cell] = 1;
    const auto now = static_cast<Offset>(std::ranges::count(is_bad, 1));
    if (round == 0) first = now;
    if (round == 0 || now < fewest) {
      fewest = now;
      best = points;
    }
    std::vector<char> moved(curved.size(), 0);
    bool any = false;
    std::vector<Index> nodes(static_cast<std::size_t>(mesh.nodes_per_cell()));
    for (const Offset cell : bad) {
      mesh.read_cell(cell, nodes);
      for (const Index n : nodes) {
        if (moved[n] != 0 || rounds[n] == shares.size()) continue;
        moved[n] = 1;
        any = true;
        points[n] = straight[n] + shares[rounds[n]++] * (curved[n] - straight[n]);
      }
    }
    if (!any) break;
    suspects.resize(static_cast<std::size_t>(mesh.cell_count()));
    std::iota(suspects.begin(), suspects.end(), Offset{0});
    suspects = filtered(mesh, suspects, [&](const std::vector<Index>& of) {
      return std::ranges::any_of(of, [&](Index n) { return moved[n] != 0; });
    });
  }
  points = std::move(best);
  return first;
}

}  // namespace flowcage
