#include "core/export/write_plot3d.hpp"

#include <fmt/format.h>

#include "core/export/patch_names.hpp"
#include "core/export/write_text.hpp"

namespace flowcage {
namespace {

constexpr std::array<int, 3> map_face{3, 5, 1};  // of i-min, j-min, k-min

const char* condition(PatchType type) {
  switch (type) {
    case PatchType::farfield:
      return "FARFIELD";
    case PatchType::symmetry:
      return "SYMMETRY";
    case PatchType::inlet:
      return "INFLOW";
    case PatchType::outlet:
      return "OUTFLOW";
    case PatchType::wall:
      break;
  }
  return "WALL";
}

/// "block face s1 e1 s2 e2" of a face that is flat along axis d.
std::string side(Index block, int face, int d, const std::array<Index, 3>& low,
                 const std::array<Index, 3>& high) {
  const int u = (d + 1) % 3, v = (d + 2) % 3;
  return fmt::format("{:6} {:2} {:6} {:6} {:6} {:6}", block + 1, map_face[d] + face % 2, low[u] + 1,
                     high[u] + 1, low[v] + 1, high[v] + 1);
}

}  // namespace

void write_plot3d(std::ostream& out, const BlockMesh& mesh, const StructuredBlocks& blocks,
                  Progress* progress) {
  if (progress) progress->step("write Plot3D", 0);
  out << fmt::format("{}\n", blocks.blocks.size());
  for (const StructuredBlock& block : blocks.blocks) {
    const auto [ni, nj, nk] = block.cells();
    out << fmt::format("{} {} {}\n", ni + 1, nj + 1, nk + 1);
  }
  for (const StructuredBlock& block : blocks.blocks) {
    const auto [ni, nj, nk] = block.cells();
    const Offset row = ni + 1, layer = row * (nj + 1), rows = nj + 1;
    for (int d = 0; d < 3; ++d) {
      write_ranges(out, layer * (nk + 1), text_grain, [&](Offset begin, Offset end, std::string& text) {
        for (Offset p = begin; p < end; ++p) {
          const std::array<Index, 3> ijk{static_cast<Index>(p % row), static_cast<Index>(p / row % rows),
                                         static_cast<Index>(p / layer)};
          append_number(text, mesh.points()[point_number(mesh, block, ijk)][d]);
          text += '\n';
        }
      });
    }
  }
  if (progress) progress->step("write Plot3D", 1);
}

std::vector<std::string> write_neutral_map(std::ostream& out, const BlockMesh& mesh,
                                           const StructuredBlocks& blocks) {
  PatchNames legal = legal_patch_names(mesh);
  out << fmt::format("# neutral map file of flowcage\n# block idim jdim kdim\n{}\n", blocks.blocks.size());
  for (std::size_t b = 0; b < blocks.blocks.size(); ++b) {
    const auto [ni, nj, nk] = blocks.blocks[b].cells();
    out << fmt::format("{:6} {:6} {:6} {:6}\n", b + 1, ni + 1, nj + 1, nk + 1);
  }
  out << "# type block1 face1 s1 e1 s2 e2 block2 face2 s1 e1 s2 e2 swap\n";
  for (std::size_t w = 0; w < blocks.windows.size(); ++w) {
    const BlockWindow& window = blocks.windows[w];
    const int d = window.face / 2;
    const std::string own = side(window.block, window.face, d, window.low, window.high);
    if (window.patch != no_index) {
      out << fmt::format("# patch {}\n{:<11}{}\n", legal.names[window.patch],
                         condition(mesh.patches()[window.patch].type), own);
      continue;
    }
    // The window behind is the same interface from the other side.
    const BlockWindow& opposite = blocks.windows[++w];
    const int there = opposite.face / 2;
    const bool swapped = std::abs(window.transform[(d + 1) % 3]) - 1 != (there + 1) % 3;
    out << fmt::format("{:<11}{} {} {}\n", "ONE-TO-ONE", own,
                       side(window.donor, opposite.face, there, window.donor_low, window.donor_high),
                       swapped ? "TRUE" : "FALSE");
  }
  return std::move(legal.notes);
}

}  // namespace flowcage
