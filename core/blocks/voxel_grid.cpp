#include "core/blocks/voxel_grid.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/hex_view.hpp"

namespace flowcage {
namespace {

/// The cells round a node; no_index outside of the grid. Slot bits: 1 upper in x, 2 in y, 4 in z.
std::array<Index, 8> cells_round(const VoxelGrid& grid, const std::array<Index, 3>& node) {
  std::array<Index, 8> result;
  for (int slot = 0; slot < 8; ++slot) {
    std::array<Index, 3> at{};
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = node[axis] - 1 + ((slot >> axis) & 1);
      inside = inside && at[axis] >= 0 && at[axis] < grid.cells(axis);
    }
    result[slot] = inside ? grid.cell(at) : no_index;
  }
  return result;
}

bool hangs_together(unsigned mask) {
  if (mask == 0) return true;
  unsigned reached = mask & (~mask + 1);
  for (int step = 0; step < 8; ++step) {
    for (int slot = 0; slot < 8; ++slot) {
      if ((reached >> slot & 1U) == 0) continue;
      for (int axis = 0; axis < 3; ++axis) reached |= mask & (1U << (slot ^ (1 << axis)));
    }
  }
  return reached == mask;
}

bool is_manifold(const VoxelGrid& grid, const std::array<Index, 3>& node) {
  unsigned body = 0, fluid = 0;
  const std::array<Index, 8> cells = cells_round(grid, node);
  for (int slot = 0; slot < 8; ++slot) {
    if (cells[slot] == no_index) continue;
    (grid.body[cells[slot]] != 0 ? body : fluid) |= 1U << slot;
  }
  return hangs_together(body) && hangs_together(fluid);
}

std::array<Index, 3> node_at(const VoxelGrid& grid, Index node) {
  return {node % grid.nodes(0), node / grid.nodes(0) % grid.nodes(1), node / (grid.nodes(0) * grid.nodes(1))};
}

int bad_nodes_of(const VoxelGrid& grid, Index cell) {
  const std::array<Index, 3> at = grid.cell_at(cell);
  int bad = 0;
  for (int slot = 0; slot < 8; ++slot) {
    bad += is_manifold(grid, {at[0] + (slot & 1), at[1] + (slot >> 1 & 1), at[2] + (slot >> 2)}) ? 0 : 1;
  }
  return bad;
}

}  // namespace

std::vector<Index> non_manifold_nodes(const VoxelGrid& grid) {
  std::vector<Index> bad;
  for (Index n = 0; n < grid.node_count(); ++n) {
    if (!is_manifold(grid, node_at(grid, n))) bad.push_back(n);
  }
  return bad;
}

Index repair_manifold(VoxelGrid& grid, std::span<const double> fraction) {
  constexpr int most_rounds = 20, most_turns = 2;
  std::vector<std::uint8_t> turns(grid.body.size(), 0);
  Index turned = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<Index> bad = non_manifold_nodes(grid);
    if (bad.empty()) break;
    for (const Index n : bad) {
      const std::array<Index, 3> node = node_at(grid, n);
      if (is_manifold(grid, node)) continue;  // by a turn for another node
      Index best = no_index;
      double best_cost = 1e300;
      for (const Index cell : cells_round(grid, node)) {
        if (cell == no_index || turns[cell] >= most_turns) continue;
        const int before = bad_nodes_of(grid, cell);
        const bool was_body = grid.body[cell] != 0;
        grid.body[cell] = was_body ? 0 : 1;
        const int after = bad_nodes_of(grid, cell);
        grid.body[cell] = was_body ? 1 : 0;
        const double volume = was_body ? fraction[cell] : 1 - fraction[cell];
        const double cost = after - before + volume + turns[cell];
        if (cost < best_cost) {
          best_cost = cost;
          best = cell;
        }
      }
      if (best == no_index) continue;
      grid.body[best] ^= 1;
      ++turns[best];
      ++turned;
    }
  }
  return turned;
}

VoxelParts voxel_parts(const VoxelGrid& grid, std::uint8_t kind) {
  VoxelParts result;
  result.part.assign(grid.body.size(), no_index);
  std::vector<Index> stack;
  for (Index seed = 0; seed < grid.cell_count(); ++seed) {
    if (grid.body[seed] != kind || result.part[seed] != no_index) continue;
    result.part[seed] = result.count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::array<Index, 3> at = grid.cell_at(stack.back());
      stack.pop_back();
      for (int axis = 0; axis < 3; ++axis) {
        for (const Index step : {-1, 1}) {
          std::array<Index, 3> next = at;
          next[axis] += step;
          if (next[axis] < 0 || next[axis] >= grid.cells(axis)) continue;
          const Index cell = grid.cell(next);
          if (grid.body[cell] != kind || result.part[cell] != no_index) continue;
          result.part[cell] = result.count;
          stack.push_back(cell);
        }
      }
    }
    ++result.count;
  }
  return result;
}

BlockDraft draft_of_voxels(const VoxelGrid& grid, std::uint8_t kind, std::vector<Index>& node) {
  // Corner n of a hex in VTK order, as steps along the axes.
  static constexpr std::array<std::array<Index, 3>, 8> corner{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  BlockDraft draft;
  std::vector<Index> number(static_cast<std::size_t>(grid.node_count()), no_index);
  std::vector<char> used(number.size(), 0);
  for (Index c = 0; c < grid.cell_count(); ++c) {
    if (grid.body[c] != kind) continue;
    const std::array<Index, 3> at = grid.cell_at(c);
    for (const auto& s : corner) used[grid.node({at[0] + s[0], at[1] + s[1], at[2] + s[2]})] = 1;
  }
  node.clear();
  for (Index n = 0; n < grid.node_count(); ++n) {
    if (used[n] == 0) continue;
    number[n] = static_cast<Index>(node.size());
    node.push_back(n);
    draft.points.push_back(grid.point(node_at(grid, n)));
  }
  for (Index c = 0; c < grid.cell_count(); ++c) {
    if (grid.body[c] != kind) continue;
    const std::array<Index, 3> at = grid.cell_at(c);
    HexPoints hex;
    for (int n = 0; n < 8; ++n) {
      hex[n] = number[grid.node({at[0] + corner[n][0], at[1] + corner[n][1], at[2] + corner[n][2]})];
    }
    draft.hexes.push_back(hex);
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2;
      std::array<Index, 3> next = at;
      next[axis] += face % 2 == 0 ? -1 : 1;
      const bool outside = next[axis] < 0 || next[axis] >= grid.cells(axis);
      if (!outside && grid.body[grid.cell(next)] == kind) continue;
      BoundaryQuad quad;
      for (int n = 0; n < 4; ++n) quad.corners[n] = hex[hex_faces[face][n]];
      quad.patch = outside ? 1 + face : 0;
      draft.boundary.push_back(quad);
    }
  }
  return draft;
}

}  // namespace flowcage
