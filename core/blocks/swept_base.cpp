#include "core/blocks/swept_base.hpp"

#include <algorithm>
#include <map>

#include "core/blocks/wall_blocks.hpp"

namespace flowcage {

void straighten_base(const SweptBlocks& swept, const SurfaceLevel& cut, const SurfaceLevel& level,
                     std::span<Vec3> points) {
  if (swept.plan.trailing != TrailingEdge::blunt) return;
  const SweptPlan& plan = swept.plan;
  const std::vector<Index> across{0, plan.middle_of(0, 7), 7, plan.middle_of(6, 7), 6};
  const HexComplex& complex = *swept.blocks.complex;
  // Rows across the base by their place along the span; where a vertex lies in its row.
  struct Row {
    Index upper = no_index, lower = no_index;
    std::vector<std::pair<Index, double>> inner;
  };
  std::map<double, Row> rows;
  const std::vector<Index> vertex_of = cut_vertices(cut, level);
  const std::vector<WallLine> lines = wall_lines(swept.blocks, cut);
  const double side = static_cast<double>(Index{1} << cut.depth);
  for (Index v = 0; v < cut.vertex_count(); ++v) {
    const WallSeat& seat = swept.blocks.seats[lines[v].face];
    const double i = lines[v].i / side;
    const double j = lines[v].j / side;
    const std::array<double, 4> weight{(1 - i) * (1 - j), i * (1 - j), i * j, (1 - i) * j};
    double down = 0;
    double span = 0;
    bool on_base = true;
    for (int c = 0; c < 4 && on_base; ++c) {
      const SweptCorner& corner = swept.corners[complex.hexes[seat.block][seat.foot[c]]];
      const auto found = std::find(across.begin(), across.end(), corner.vertex);
      on_base = found != across.end();
      down += weight[c] * static_cast<double>(found - across.begin()) / 4;
      span += weight[c] * corner.level;
    }
    if (!on_base) continue;
    Row& row = rows[span];
    if (down == 0) {
      row.upper = vertex_of[v];
    } else if (down == 1) {
      row.lower = vertex_of[v];
    } else {
      row.inner.emplace_back(vertex_of[v], down);
    }
  }
  for (const auto& [span, row] : rows) {
    for (const auto& [v, down] : row.inner) {
      points[v] = (1 - down) * points[row.upper] + down * points[row.lower];
    }
  }
}

}  // namespace flowcage
