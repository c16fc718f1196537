#include "core/export/write_gmsh.hpp"

#include <fmt/format.h>

#include "core/export/curved_order.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/write_curved.hpp"
#include "core/export/write_text.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {
namespace {

constexpr int surface_dimension = 2, volume_dimension = 3;
constexpr int gmsh_quad = 3, gmsh_hexahedron = 5;

/// The points of each entity, ascending: the patches' surfaces, then the volume.
std::vector<std::vector<Index>> points_of_entities(const HexView& mesh) {
  const std::size_t count = mesh.patches().size();
  std::vector<std::size_t> entity(mesh.points().size(), count);
  for (std::size_t i = count; i-- > 0;) {
    for (const auto& quad : mesh.patches()[i].quads) {
      for (const Index p : quad) entity[p] = i;
    }
  }
  std::vector<std::vector<Index>> result(count + 1);
  for (std::size_t p = 0; p < entity.size(); ++p) result[entity[p]].push_back(static_cast<Index>(p));
  return result;
}

class GmshWriter {
 public:
  GmshWriter(std::ostream& out, const HexView& mesh)
      : out_(out),
        mesh_(mesh),
        patches_(mesh.patches()),
        entities_(points_of_entities(mesh)),
        node_(mesh.points().size()) {
    Index next = 0;
    for (const auto& points : entities_) {
      for (const Index p : points) node_[p] = next++;
    }
    for (const BoundaryPatch& patch : patches_) quads_ += static_cast<Offset>(patch.quads.size());
  }

  void groups_and_entities(const std::vector<std::string>& names) {
    const std::size_t volume_group = names.size() + 1;
    out_ << fmt::format("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", volume_group);
    for (std::size_t i = 0; i < names.size(); ++i) {
      out_ << fmt::format("{} {} \"{}\"\n", surface_dimension, i + 1, names[i]);
    }
    out_ << fmt::format("{} {} \"volume\"\n$EndPhysicalNames\n$Entities\n0 0 {} 1\n", volume_dimension,
                        volume_group, names.size());
    Box3 all;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      Box3 box;
      for (const auto& quad : patches_[i].quads) {
        for (const Index p : quad) box.extend(mesh_.points()[p]);
      }
      all.extend(box);
      entity(i + 1, box, i + 1);
      out_ << " 0\n";
    }
    entity(1, all, volume_group);
    out_ << fmt::format(" {}", patches_.size());
    for (std::size_t i = 0; i < patches_.size(); ++i) out_ << fmt::format(" {}", i + 1);
    out_ << "\n$EndEntities\n";
  }

  void nodes() {
    const std::size_t count = mesh_.points().size();
    out_ << fmt::format("$Nodes\n{} {} 1 {}\n", entities_.size(), count, count);
    for (std::size_t i = 0; i < entities_.size(); ++i) {
      const auto& points = entities_[i];
      const auto number = static_cast<Offset>(points.size());
      const bool volume = i == patches_.size();
      out_ << fmt::format("{} {} 0 {}\n", volume ? volume_dimension : surface_dimension, volume ? 1 : i + 1,
                          number);
      write_ranges(out_, number, text_grain, [&](Offset begin, Offset end, std::string& text) {
        for (Offset p = begin; p < end; ++p) append_row(text, std::array{node_[points[p]]}, 1);
      });
      write_point_rows(out_, number, [&](Offset p) { return mesh_.points()[points[p]]; });
    }
    out_ << "$EndNodes\n";
  }

  /// `mesh` is this writer's mesh seen as curved cells.
  void curved_elements(const CurvedMesh& mesh) {
    constexpr std::array<int, 5> quad_type{0, 3, 10, 36, 37}, hex_type{0, 5, 12, 92, 93};
    const CurvedOrder order = gmsh_order(mesh.order);
    const Offset per_quad = mesh.nodes_per_quad();
    const Offset quads = quads_ / (mesh.order * mesh.order), count = quads + mesh.cell_count();
    out_ << fmt::format("$Elements\n{} {} 1 {}\n", patches_.size() + 1, count, count);
    const auto row = [this](std::string& text, Offset tag, const Index* nodes,
                            const std::vector<int>& places) {
      append_number(text, tag);
      for (const int at : places) {
        text += ' ';
        append_number(text, node_[nodes[at]] + 1);
      }
      text += '\n';
    };
    Offset next = 1;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      const std::vector<Index> nodes = mesh.patch_quads(i);
      const Offset own = static_cast<Offset>(nodes.size()) / per_quad;
      out_ << fmt::format("{} {} {} {}\n", surface_dimension, i + 1, quad_type[mesh.order], own);
      write_ranges(out_, own, text_grain, [&](Offset begin, Offset end, std::string& text) {
        for (Offset q = begin; q < end; ++q) row(text, next + q, &nodes[q * per_quad], order.quad);
      });
      next += own;
    }
    out_ << fmt::format("{} 1 {} {}\n", volume_dimension, hex_type[mesh.order], mesh.cell_count());
    write_ranges(out_, mesh.cell_count(), cell_grain, [&](Offset begin, Offset end, std::string& text) {
      std::vector<Index> nodes(static_cast<std::size_t>(mesh.nodes_per_cell()));
      for (Offset c = begin; c < end; ++c) {
        mesh.read_cell(c, nodes);
        row(text, next + c, nodes.data(), order.hex);
      }
    });
    out_ << "$EndElements\n";
  }

  void elements() {
    const Offset count = quads_ + mesh_.cell_count();
    out_ << fmt::format("$Elements\n{} {} 1 {}\n", patches_.size() + 1, count, count);
    Offset next = 1;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      const auto& quads = patches_[i].quads;
      out_ << fmt::format("{} {} {} {}\n", surface_dimension, i + 1, gmsh_quad, quads.size());
      write_ranges(out_, static_cast<Offset>(quads.size()), text_grain,
                   [&](Offset begin, Offset end, std::string& text) {
                     for (Offset q = begin; q < end; ++q) element(text, next + q, quads[q]);
                   });
      next += static_cast<Offset>(quads.size());
    }
    out_ << fmt::format("{} 1 {} {}\n", volume_dimension, gmsh_hexahedron, mesh_.cell_count());
    write_ranges(out_, mesh_.cell_count(), cell_grain, [&](Offset begin, Offset end, std::string& text) {
      visit_cells(mesh_, begin, end, [&](Offset c, const HexPoints& cell) { element(text, next + c, cell); });
    });
    out_ << "$EndElements\n";
  }

 private:
  /// Number, bounding box and physical group of a surface or volume.
  void entity(std::size_t tag, const Box3& box, std::size_t group) {
    const Vec3 low = box.isEmpty() ? Vec3::Zero() : box.min(), high = box.isEmpty() ? low : box.max();
    out_ << fmt::format("{} {} {} {} {} {} {} 1 {}", tag, low.x(), low.y(), low.z(), high.x(), high.y(),
                        high.z(), group);
  }
  template <std::size_t N>
  void element(std::string& text, Offset tag, std::array<Index, N> points) const {
    for (Index& p : points) p = node_[p];
    append_number(text, tag);
    text += ' ';
    append_row(text, points, 1);
  }

  std::ostream& out_;
  const HexView& mesh_;
  const std::vector<BoundaryPatch>& patches_;
  std::vector<std::vector<Index>> entities_;  ///< points of each
  std::vector<Index> node_;                   ///< position of each point in the file
  Offset quads_ = 0;
};

}  // namespace

std::vector<std::string> write_gmsh(std::ostream& out, const HexView& mesh, Progress* progress) {
  if (progress) progress->step("write Gmsh mesh", 0);
  PatchNames legal = legal_patch_names(mesh);
  GmshWriter writer(out, mesh);
  writer.groups_and_entities(legal.names);
  writer.nodes();
  writer.elements();
  if (progress) progress->step("write Gmsh mesh", 1);
  return std::move(legal.notes);
}

std::vector<std::string> write_curved_gmsh(std::ostream& out, const CurvedMesh& mesh, Progress* progress) {
  if (progress) progress->step("write Gmsh mesh", 0);
  PatchNames legal = legal_patch_names(mesh.nodes);
  GmshWriter writer(out, mesh.nodes);
  writer.groups_and_entities(legal.names);
  writer.nodes();
  writer.curved_elements(mesh);
  if (progress) progress->step("write Gmsh mesh", 1);
  return std::move(legal.notes);
}

}  // namespace flowcage
