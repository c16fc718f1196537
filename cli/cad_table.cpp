#include "cli/cad_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace flowcage {
namespace {

constexpr std::size_t names_shown = 20, faces_shown = 60, borders_shown = 30, problems_shown = 50;

std::string row(std::string_view name, const std::string& value) {
  return fmt::format("  {:<14}{}\n", name, value);
}

std::string heading(std::string_view title, std::size_t count) {
  return fmt::format("{} ({})\n", title, count);
}

std::string rest(std::size_t count, std::size_t most) {
  return count > most ? fmt::format("  ... and {} more (--json has all)\n", count - most) : "";
}

std::string list(std::string_view title, const std::vector<std::string>& entries, std::size_t most) {
  if (entries.empty()) return "";
  std::string text = heading(title, entries.size());
  for (std::size_t i = 0; i < std::min(most, entries.size()); ++i) text += fmt::format("  {}\n", entries[i]);
  return text + rest(entries.size(), most);
}

std::string counts(std::string_view title, const std::vector<NamedCount>& values) {
  std::vector<std::string> entries;
  for (const NamedCount& value : values) {
    entries.push_back(fmt::format("{}  {} face{}", value.name, value.count, value.count == 1 ? "" : "s"));
  }
  return list(title, entries, names_shown);
}

std::string size_text(const Vec3& size) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", size.x(), size.y(), size.z());
}

std::string files_text(const CadSummary& cad) {
  std::string text;
  for (const CadFile& file : cad.files) {
    text += fmt::format("{}\n", file.name);
    text += row("format", file.format);
    const std::string unit = file.unit.empty() ? "none stated" : file.unit;
    text += row("unit", file.unit_in_metres > 0 ? fmt::format("{} (1 is {:g} m)", unit, file.unit_in_metres)
                                                : fmt::format("{} (as the file defines it)", unit));
    text += row("holds", fmt::format("{} solid(s), {} face(s)", file.solids, file.faces));
  }
  return text;
}

std::string free_edges_text(const CadSummary& cad) {
  std::string text = fmt::format("{}", cad.free_edges);
  if (cad.sewing_tolerance > 0) {
    text += fmt::format(" after sewing at {:.2g} m, {} before", cad.sewing_tolerance, cad.free_edges_before);
  }
  if (cad.free_edges != cad.free_edges_sewn) {
    text += fmt::format(" ({} before faces were split)", cad.free_edges_sewn);
  }
  return text;
}

std::string overlap_text(const CadOverlap& overlap) {
  std::string bodies;
  for (const Index body : overlap.bodies) bodies += fmt::format("{}{}", bodies.empty() ? "" : ", ", body);
  if (!overlap.united)
    return fmt::format("bodies {} of those read: not united ({})", bodies, overlap.problem);
  return fmt::format("bodies {} of those read: united, {} face(s) cut, {} hidden piece(s) left out", bodies,
                     overlap.split_faces, overlap.hidden_pieces);
}

std::string model_text(const CadSummary& cad) {
  const Vec3 size = cad.bounds.sizes();
  std::string text = "model, in metres\n";
  text += row("from", place(cad.bounds.min()));
  text += row("to", place(cad.bounds.max()));
  text += row("size", fmt::format("{:.6g} x {:.6g} x {:.6g}, diagonal {:.6g}", size.x(), size.y(), size.z(),
                                  cad.diagonal));
  text += row("bodies", fmt::format("{} solid(s), {} shell(s), {} of them open", cad.solids, cad.shells,
                                    cad.open_shells));
  for (const CadOverlap& overlap : cad.overlaps) text += row("overlap", overlap_text(overlap));
  std::string kinds;
  for (const NamedCount& kind : cad.faces_by_kind) {
    kinds += fmt::format("{}{} {}", kinds.empty() ? ": " : ", ", kind.count, kind.name);
  }
  if (cad.faces_left_out > 0)
    kinds += fmt::format("; {} left out by --include, --exclude", cad.faces_left_out);
  text += row("faces", fmt::format("{}{}", cad.faces, kinds));
  text += row("edges", fmt::format("{}, vertices {}", cad.edges, cad.vertices));
  text += row("free edges", free_edges_text(cad));
  text += row("sharp edges",
              fmt::format("{} in {} chain(s){}", cad.sharp_edges, cad.sharp_chains,
                          cad.partly_sharp_edges > 0
                              ? fmt::format(", {} sharp on a part of their length", cad.partly_sharp_edges)
                              : ""));
  if (cad.intersection_chains > 0) {
    text += row("", fmt::format("of them {} chain(s) where bodies meet", cad.intersection_chains));
  }
  text += row("open border", fmt::format("{} chain(s)", cad.boundary_chains));
  text += row("corners", fmt::format("{}", cad.corners));
  if (cad.tips > 0) text += row("tips of cones", fmt::format("{}", cad.tips));
  return text;
}

/// One row a face: what --include and --exclude choose by.
std::string faces_text(const CadModel& model) {
  const auto count = static_cast<std::size_t>(model.face_count());
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](Index f) { return model.face(f).number; });
  std::string text = heading("faces: number, kind, size and middle in m, patch name", count);
  for (std::size_t f = 0; f < std::min(count, faces_shown); ++f) {
    const CadFace& face = model.face(order[f]);
    const std::string where =
        face.bounds.isEmpty()
            ? std::string("no triangles")
            : fmt::format("{:<30} {:<34}", size_text(face.bounds.sizes()), place(face.bounds.center()));
    text += fmt::format("  {:>4}  {:<10}  {} {}", face.number, face.kind, where, face.group);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text + rest(count, faces_shown);
}

std::string borders_text(const CadSummary& cad) {
  if (cad.borders.empty()) return "";
  std::string text = heading("open borders", cad.borders.size());
  for (std::size_t b = 0; b < std::min(cad.borders.size(), borders_shown); ++b) {
    const OpenBorder& border = cad.borders[b];
    text += fmt::format("  loop {}{}: {:.4g} m near {}: {}\n", border.loop + 1,
                        border.closed ? "" : " (does not close)", border.length, place(border.place),
                        border_text(border));
  }
  return text + rest(cad.borders.size(), borders_shown);
}

}  // namespace

std::string border_text(const OpenBorder& border) {
  const std::string plane =
      border.axis >= 0 ? fmt::format("{} = {:.6g}", "xyz"[border.axis], border.value)
                       : fmt::format("the plane {} . x = {:.6g}", place(border.normal), border.value);
  switch (border.kind) {
    case BorderKind::plane:
      return "symmetry plane, waterline or open end in " + plane;
    case BorderKind::gap:
      if (border.width <= 1e-9 * border.length) return "edges that lie on each other and are not joined";
      return fmt::format("a gap up to {:.3g} m wide, to be closed", border.width);
    case BorderKind::hole:
      return "a hole in " + plane + ", to be capped";
    case BorderKind::sheet:
      break;
  }
  return "the rim of an open sheet";
}

std::string cad_table(const CadModel& model) {
  const CadSummary& cad = model.summary();
  std::string text = files_text(cad) + model_text(cad);
  text += list("names of solids", cad.solid_names, names_shown);
  text += counts("parts", cad.parts) + counts("layers", cad.layers) + counts("colours", cad.colors);
  text += counts("patch names", cad.groups);
  text += faces_text(model) + borders_text(cad);
  return text + list("problems", cad.warnings, problems_shown);
}

}  // namespace flowcage
