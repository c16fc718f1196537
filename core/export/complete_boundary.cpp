#include "core/export/complete_boundary.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/base/error.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {
namespace {

void refuse_collapsed_cells(const std::vector<HexPoints>& cells) {
  for (std::size_t c = 0; c < cells.size(); ++c) {
    HexPoints sorted = cells[c];
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice == sorted.end()) continue;
    throw Error(ErrorKind::input, fmt::format("cell {} has point {} twice: it is no hex", c, *twice),
                "flowcage reads meshes of hexes with eight different points only");
  }
}

}  // namespace

HexMesh complete_boundary(std::vector<Vec3> points, std::vector<HexPoints> cells,
                          std::vector<BoundaryPatch> patches) {
  refuse_collapsed_cells(cells);
  const HexMesh given(std::move(points), std::move(cells), std::move(patches));
  const FaceMatching matching = match_faces(given);
  std::vector<BoundaryPatch> complete = given.patches();
  std::vector<std::pair<std::size_t, std::size_t>> quad_place;  // patch and position of each quad
  for (std::size_t i = 0; i < complete.size(); ++i) {
    complete[i].owner.resize(complete[i].quads.size());
    for (std::size_t q = 0; q < complete[i].quads.size(); ++q) quad_place.emplace_back(i, q);
  }
  BoundaryPatch rest{complete.empty() ? "boundary" : "unassigned", PatchType::wall, {}, {}};
  visit_cells(given, 0, given.cell_count(), [&](Offset c, const HexPoints& cell) {
    for (int f = 0; f < 6; ++f) {
      const Index across = matching.adjacency.across[6 * c + f];
      if (across >= 0) continue;
      const bool covered = across != uncovered_face;
      const auto [patch, quad] = covered ? quad_place[~across] : std::pair(complete.size(), std::size_t{0});
      if (covered) {
        complete[patch].quads[quad] = face_points(cell, f);
        complete[patch].owner[quad] = static_cast<Index>(c);
      } else {
        rest.quads.push_back(face_points(cell, f));
        rest.owner.push_back(static_cast<Index>(c));
      }
    }
  });
  if (!rest.quads.empty()) complete.push_back(std::move(rest));
  std::vector<HexPoints> all(static_cast<std::size_t>(given.cell_count()));
  given.read_cells(0, all);
  return {std::vector<Vec3>(given.points().begin(), given.points().end()), std::move(all),
          std::move(complete)};
}

}  // namespace flowcage
