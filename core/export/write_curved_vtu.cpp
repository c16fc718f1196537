#include <fmt/format.h>

#include <limits>
#include <utility>

#include "core/export/curved_order.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/vtk_xml.hpp"
#include "core/export/write_curved.hpp"

namespace flowcage {
namespace {

constexpr std::uint8_t lagrange_quadrilateral = 70, lagrange_hexahedron = 72;
using Part = AppendedArrays::Part;

/// Rows of node numbers in the format's order.
Part quad_part(const std::vector<Index>& quads, const std::vector<int>& order) {
  const auto n = static_cast<Offset>(order.size());
  return computed_part<Index>(static_cast<Offset>(quads.size()),
                              [&quads, &order, n](Offset i) { return quads[i / n * n + order[i % n]]; });
}

Part hex_part(const CurvedMesh& mesh, const std::vector<int>& order) {
  return {mesh.cell_count(), static_cast<Offset>(order.size() * sizeof(Index)),
          [&mesh, &order](Offset begin, Offset end, std::string& bytes) {
            std::vector<Index> nodes(order.size());
            for (Offset cell = begin; cell < end; ++cell) {
              mesh.read_cell(cell, nodes);
              for (const int at : order) append_raw(bytes, nodes[at]);
            }
          }};
}

}  // namespace

std::vector<std::string> write_curved_vtu(std::ostream& out, const CurvedMesh& mesh, Progress* progress) {
  if (progress) progress->step("write VTU", 0);
  auto [names, notes] = legal_patch_names(mesh.nodes);
  const CurvedOrder order = vtk_order(mesh.order);
  const Offset cells = mesh.cell_count();
  const Offset of_hex = mesh.nodes_per_cell(), of_quad = mesh.nodes_per_quad();
  std::vector<int> types;
  std::vector<std::vector<Index>> quads;
  Offset quad_count = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    types.push_back(static_cast<int>(mesh.nodes.patches()[i].type));
    quads.push_back(mesh.patch_quads(i));
    quad_count += static_cast<Offset>(quads.back().size()) / of_quad;
  }
  AppendedArrays arrays;
  std::vector<Part> connectivity{hex_part(mesh, order.hex)};
  std::vector<Part> ids{computed_part<Index>(cells, [](Offset) { return no_index; })};
  for (std::size_t i = 0; i < quads.size(); ++i) {
    connectivity.push_back(quad_part(quads[i], order.quad));
    ids.push_back(computed_part<Index>(static_cast<Offset>(quads[i].size()) / of_quad,
                                       [i](Offset) { return static_cast<Index>(i); }));
  }
  const auto hex_end = [of_hex](Offset c) { return of_hex * (c + 1); };
  const auto quad_end = [=](Offset q) { return of_hex * cells + of_quad * (q + 1); };
  const std::string xml =
      vtk_file_header("UnstructuredGrid", "2.2") + "<UnstructuredGrid>\n" + patch_field_data(names, types) +
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<CellData>\n",
                  mesh.nodes.points().size(), cells + quad_count) +
      arrays.declare("Int32", "patchId", 1, std::move(ids)) + "</CellData>\n<Points>\n" +
      arrays.declare("Float64", "Points", 3, {array_part(mesh.nodes.points())}) + "</Points>\n<Cells>\n" +
      arrays.declare("Int32", "connectivity", 1, std::move(connectivity)) +
      arrays.declare("Int64", "offsets", 1,
                     {computed_part<Offset>(cells, hex_end), computed_part<Offset>(quad_count, quad_end)}) +
      arrays.declare(
          "UInt8", "types", 1,
          {computed_part<std::uint8_t>(cells, [](Offset) { return lagrange_hexahedron; }),
           computed_part<std::uint8_t>(quad_count, [](Offset) { return lagrange_quadrilateral; })}) +
      "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
  out << xml;
  arrays.write(out);
  out << "</VTKFile>\n";
  if (progress) progress->step("write VTU", 1);
  return std::move(notes);
}

}  // namespace flowcage
