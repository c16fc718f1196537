#include "core/export/write_su2.hpp"

#include <fmt/format.h>

#include "core/export/patch_names.hpp"
#include "core/export/write_text.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {

std::vector<std::string> write_su2(std::ostream& out, const HexView& mesh, Progress* progress) {
  if (progress) progress->step("write SU2", 0);
  PatchNames legal = legal_patch_names(mesh);
  out << fmt::format("NDIME= 3\nNELEM= {}\n", mesh.cell_count());
  write_ranges(out, mesh.cell_count(), cell_grain, [&](Offset begin, Offset end, std::string& text) {
    visit_cells(mesh, begin, end, [&](Offset, const HexPoints& cell) {
      text += "12 ";
      append_row(text, cell, 0);
    });
  });
  out << fmt::format("NPOIN= {}\n", mesh.points().size());
  write_point_rows(out, static_cast<Offset>(mesh.points().size()),
                   [&](Offset p) { return mesh.points()[p]; });
  out << fmt::format("NMARK= {}\n", mesh.patches().size());
  for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
    const auto& quads = mesh.patches()[i].quads;
    out << fmt::format("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", legal.names[i], quads.size());
    write_ranges(out, static_cast<Offset>(quads.size()), text_grain,
                 [&](Offset begin, Offset end, std::string& text) {
                   for (Offset q = begin; q < end; ++q) {
                     text += "9 ";
                     append_row(text, quads[q], 0);
                   }
                 });
  }
  if (progress) progress->step("write SU2", 1);
  return std::move(legal.notes);
}

}  // namespace flowcage
