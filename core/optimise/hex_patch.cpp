#include "core/optimise/hex_patch.hpp"

#include <numeric>

namespace flowcage {
namespace {

Index root(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// Numbers the chosen cells by the connected region they lie in, in order of the regions' first cells;
/// no_index for cells without a moving point.
std::vector<Index> label_regions(std::span<const HexPoints> cells, std::span<const Offset> chosen,
                                 std::span<const std::uint8_t> moves, Index& count) {
  std::vector<Index> parent(moves.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  std::vector<Index> first_moving(chosen.size(), no_index);
  for (std::size_t n = 0; n < chosen.size(); ++n) {
    for (const Index p : cells[chosen[n]]) {
      if (moves[p] == 0) continue;
      if (first_moving[n] == no_index) {
        first_moving[n] = p;
      } else {
        parent[root(parent, p)] = root(parent, first_moving[n]);
      }
    }
  }
  std::vector<Index> number(moves.size(), no_index);
  std::vector<Index> label(chosen.size(), no_index);
  count = 0;
  for (std::size_t n = 0; n < chosen.size(); ++n) {
    if (first_moving[n] == no_index) continue;
    Index& own = number[root(parent, first_moving[n])];
    if (own == no_index) own = count++;
    label[n] = own;
  }
  return label;
}

std::vector<HexPatch> split(std::span<const HexPoints> cells, std::span<const PointFreedom> freedom,
                            std::span<const Offset> chosen, std::span<const std::uint8_t> moves) {
  Index count = 0;
  const std::vector<Index> label = label_regions(cells, chosen, moves, count);
  std::vector<HexPatch> patches(static_cast<std::size_t>(count));
  for (std::size_t n = 0; n < chosen.size(); ++n) {
    if (label[n] != no_index) patches[label[n]].cell_of.push_back(chosen[n]);
  }
  std::vector<Index> local(moves.size(), no_index);
  for (HexPatch& patch : patches) {
    for (const Offset cell : patch.cell_of) {
      for (const Index p : cells[cell]) {
        if (local[p] == no_index) {
          local[p] = 0;
          patch.point_of.push_back(p);
        }
      }
    }
    std::sort(patch.point_of.begin(), patch.point_of.end());
    for (std::size_t n = 0; n < patch.point_of.size(); ++n) {
      const Index p = patch.point_of[n];
      local[p] = static_cast<Index>(n);
      patch.freedom.push_back(moves[p] != 0 ? freedom[p] : fixed_point);
      if (moves[p] != 0) patch.moving.push_back(static_cast<Index>(n));
    }
    for (const Offset cell : patch.cell_of) {
      HexPoints own;
      for (int c = 0; c < 8; ++c) own[c] = local[cells[cell][c]];
      patch.cells.push_back(own);
    }
    for (const Index p : patch.point_of) local[p] = no_index;
  }
  return patches;
}

}  // namespace

std::vector<HexPatch> whole_mesh_patches(std::span<const HexPoints> cells,
                                         std::span<const PointFreedom> freedom) {
  std::vector<Offset> chosen(cells.size());
  std::iota(chosen.begin(), chosen.end(), Offset{0});
  std::vector<std::uint8_t> moves(freedom.size());
  for (std::size_t p = 0; p < freedom.size(); ++p) moves[p] = freedom[p].moves() ? 1 : 0;
  return split(cells, freedom, chosen, moves);
}

std::vector<HexPatch> patches_round(std::span<const HexPoints> cells, std::span<const PointFreedom> freedom,
                                    std::span<const std::uint8_t> seeds, int rings) {
  std::vector<std::uint8_t> inside(seeds.begin(), seeds.end());
  std::vector<std::uint8_t> touched(freedom.size());
  for (int ring = 0; ring < rings; ++ring) {
    for (std::size_t n = 0; n < cells.size(); ++n) {
      if (inside[n] == 0) continue;
      for (const Index p : cells[n]) touched[p] = 1;
    }
    for (std::size_t n = 0; n < cells.size(); ++n) {
      if (inside[n] != 0) continue;
      inside[n] = std::any_of(cells[n].begin(), cells[n].end(), [&](Index p) { return touched[p] != 0; });
    }
  }
  std::vector<std::uint8_t> moves(freedom.size());
  for (std::size_t p = 0; p < freedom.size(); ++p) moves[p] = freedom[p].moves() ? 1 : 0;
  std::vector<Offset> chosen;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    if (inside[n] != 0) {
      chosen.push_back(static_cast<Offset>(n));
    } else {
      for (const Index p : cells[n]) moves[p] = 0;
    }
  }
  return split(cells, freedom, chosen, moves);
}

}  // namespace flowcage
