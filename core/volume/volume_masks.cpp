#include "core/volume/volume_masks.hpp"

#include <algorithm>
#include <cstdint>

#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

/// Adds weight/count to each corner whose position agrees with `side` on every axis where side is not -1:
/// the mean of the cell's corner, edge, face or of all corners.
void add_mean(std::array<double, 8>& mask, std::array<int, 3> side, double weight) {
  int count = 8;
  for (const int s : side) count /= s >= 0 ? 2 : 1;
  for (int c = 0; c < 8; ++c) {
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) inside &= side[axis] < 0 || side[axis] == hex_corner_ijk[c][axis];
    if (inside) mask[c] += weight / count;
  }
}

enum class Rule : std::uint8_t { smooth, crease, corner };

Rule rule_of(std::span<const double> edge_sharpness, double vertex_sharpness) {
  const auto sharp =
      std::count_if(edge_sharpness.begin(), edge_sharpness.end(), [](double s) { return s > 0; });
  if (vertex_sharpness > 0 || sharp > 2) return Rule::corner;
  return sharp == 2 ? Rule::crease : Rule::smooth;
}

}  // namespace

std::array<double, 8> cell_mask(std::array<int, 3> site, Index cells_at_edge) {
  std::array<int, 3> side{};  // of the entity in the cell that the point refines; -1 along it
  int middle = 0;
  for (int axis = 0; axis < 3; ++axis) {
    side[axis] = site[axis] == 1 ? -1 : site[axis] / 2;
    middle += site[axis] == 1 ? 1 : 0;
  }
  std::array<double, 8> mask{};
  switch (middle) {
    case 3:
      add_mean(mask, side, 1);
      break;
    case 2:
      add_mean(mask, {-1, -1, -1}, 0.5);
      add_mean(mask, side, 0.5);
      break;
    case 1: {
      const double n = cells_at_edge;
      add_mean(mask, {-1, -1, -1}, 1 / n);
      for (int axis = 0; axis < 3; ++axis) {  // the two faces that contain the edge
        if (side[axis] < 0) continue;
        std::array<int, 3> face{-1, -1, -1};
        face[axis] = side[axis];
        add_mean(mask, face, 1 / n);
      }
      add_mean(mask, side, (n - 3) / n);
      break;
    }
    default:
      for (int c = 0; c < 8; ++c) {
        double w = 1.0 / 64;
        for (int axis = 0; axis < 3; ++axis) w *= hex_corner_ijk[c][axis] == side[axis] ? 3 : 1;
        mask[c] = w;
      }
  }
  return mask;
}

std::array<double, 4> quad_edge_mask() {
  return {3.0 / 8, 3.0 / 8, 1.0 / 8, 1.0 / 8};
}

std::array<double, 4> quad_vertex_mask(Index valence) {
  const double n = valence;
  // F = (1 1 1 1)/4, E_a + E_b = (2 1 0 1)/2, P = (1 0 0 0)
  return {(1.25 + n - 3) / n, 0.75 / n, 0.25 / n, 0.75 / n};
}

VertexRule vertex_rule(std::span<const double> edge_sharpness, double vertex_sharpness) {
  VertexRule result;
  const auto share = [&](Rule rule) -> double& {
    return rule == Rule::smooth ? result.smooth : (rule == Rule::crease ? result.crease : result.corner);
  };
  const auto mark_crease = [&](double above) {
    int found = 0;
    for (std::size_t e = 0; e < edge_sharpness.size() && found < 2; ++e) {
      if (edge_sharpness[e] > above) result.crease_edges[found++] = static_cast<Index>(e);
    }
  };
  const Rule parent = rule_of(edge_sharpness, vertex_sharpness);
  if (parent == Rule::crease) mark_crease(0);
  double sum = 0;
  int decaying = 0;
  int lasting = 0;
  for (const double s : edge_sharpness) {
    if (s > 0 && s <= 1) {
      sum += s;
      ++decaying;
    }
    lasting += s > 1 ? 1 : 0;
  }
  if (vertex_sharpness > 0 && vertex_sharpness <= 1) {
    sum += vertex_sharpness;
    ++decaying;
  }
  const Rule child =
      vertex_sharpness > 1 || lasting > 2 ? Rule::corner : (lasting == 2 ? Rule::crease : Rule::smooth);
  if (parent == Rule::smooth || parent == child) {
    share(parent) = 1;
    return result;
  }
  const double of_parent = sum / decaying;  // the rules differ, so something decays
  share(parent) = of_parent;
  share(child) += 1 - of_parent;
  if (child == Rule::crease) mark_crease(1);
  return result;
}

}  // namespace flowcage
