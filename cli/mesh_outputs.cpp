#include "cli/mesh_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "core/base/atomic_file.hpp"
#include "core/base/error.hpp"
#include "core/export/file_text.hpp"
#include "core/export/write_cgns.hpp"
#include "core/export/write_curved.hpp"
#include "core/export/write_gmsh.hpp"
#include "core/export/write_plot3d.hpp"
#include "core/export/write_polymesh.hpp"
#include "core/export/write_su2.hpp"
#include "core/export/write_vtm.hpp"
#include "core/export/write_vtu.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/quality/jacobian.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

enum class Format { vtu, vtm, cgns, plot3d, gmsh, su2, foam_file, folder };
constexpr const char* known_formats =
    "give X.vtu, X.vtm, X.cgns, X.xyz, X.msh, X.su2, X.foam or a folder (with / at its end)";

Format format_of(const std::string& name) {
  const std::string extension = lower_extension(name);
  if (extension == ".vtu") return Format::vtu;
  if (extension == ".vtm") return Format::vtm;
  if (extension == ".cgns") return Format::cgns;
  if (extension == ".xyz" || extension == ".p3d") return Format::plot3d;
  if (extension == ".msh") return Format::gmsh;
  if (extension == ".su2") return Format::su2;
  if (extension == ".foam") return Format::foam_file;
  if (extension.empty() || fs::is_directory(name)) return Format::folder;
  throw Error(ErrorKind::usage, fmt::format("-o: {}: unknown mesh format {}", name, extension),
              known_formats);
}

/// The blocks of a mesh, made when the first structured format asks for them.
class BlocksOnDemand {
 public:
  explicit BlocksOnDemand(const HexView& mesh) : view_(mesh), own_(dynamic_cast<const BlockMesh*>(&mesh)) {}

  const BlockMesh& mesh() {
    if (own_) return *own_;
    if (!made_) made_.emplace(blocks_of_cells(view_));
    return *made_;
  }
  const StructuredBlocks& merged() {
    if (!merged_) merged_ = merge_blocks(mesh());
    return *merged_;
  }

 private:
  const HexView& view_;
  const BlockMesh* own_;
  std::optional<BlockMesh> made_;
  std::optional<StructuredBlocks> merged_;
};

/// The fields of the VTK formats.
class VtkFields {
 public:
  VtkFields(const HexView& mesh, const std::vector<double>& deviation)
      : jacobians_(scaled_jacobians(mesh)), deviation_(deviation.begin(), deviation.end()) {}
  VtuFields fields() const {
    VtuFields fields{{{"scaled_jacobian", jacobians_, {}}}, {}};
    if (!deviation_.empty()) fields.point_fields.push_back({"deviation", deviation_});
    return fields;
  }

 private:
  std::vector<float> jacobians_, deviation_;
};

}  // namespace

struct MeshOutputs::Output {
  Format format;
  std::string name;
  std::unique_ptr<AtomicFile> file;
  std::unique_ptr<AtomicFile> map;       ///< beside a Plot3D grid
  std::unique_ptr<AtomicFolder> pieces;  ///< beside a VTM file
  std::unique_ptr<AtomicFolder> poly_mesh;
  fs::path case_folder;
  std::string foam_file;
  std::vector<FoamCaseFile> case_files;  ///< of --case
};

/// A mesh and what several formats need of it, made when the first asks.
struct MeshOutputs::LinearMesh {
  const HexView& mesh;
  const std::vector<double>& deviation;
  std::optional<HexAdjacency> adjacency;
  BlocksOnDemand blocks;
};

void MeshOutputs::check_formats(const std::vector<std::string>& names) {
  for (const std::string& name : names) format_of(name);
}

bool MeshOutputs::has_foam_case(const std::vector<std::string>& names) {
  return std::ranges::any_of(names, [](const std::string& name) {
    const Format format = format_of(name);
    return format == Format::foam_file || format == Format::folder;
  });
}

bool MeshOutputs::holds_curved(const std::string& name) {
  const Format format = format_of(name);
  return format == Format::vtu || format == Format::gmsh || format == Format::cgns;
}

double MeshOutputs::predicted_bytes(const std::string& name, double cells, bool unstructured) {
  // A cell has about one point (24 bytes) and three faces; text was measured on a sphere of 49,000 cells.
  switch (format_of(name)) {
    case Format::vtu:
      return 72 * cells;
    case Format::vtm:
      return 48 * cells;
    case Format::cgns:
      return (unstructured ? 56 : 26) * cells;
    case Format::plot3d:
      return 60 * cells;
    case Format::gmsh:
      return 115 * cells;
    case Format::su2:
      return 105 * cells;
    case Format::foam_file:
    case Format::folder:
      return (24 + 3 * (4 + 16 + 4 + 4)) * cells;
  }
  return 0;
}

MeshOutputs::MeshOutputs(const Options& options) : unit_(options.unit), unstructured_(options.unstructured) {
  for (const std::string& name : options.outputs) {
    Output& output = outputs_.emplace_back();
    output.format = format_of(name);
    output.name = name;
    const fs::path path(name);
    if (output.format == Format::foam_file) {
      output.case_folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
      output.foam_file = path.filename().string();
    } else if (output.format == Format::folder) {
      output.case_folder = path;
      output.foam_file = "case.foam";
    } else {
      output.file = std::make_unique<AtomicFile>(path);
      if (output.format == Format::vtm) {
        const fs::path folder = vtm_folder(path);
        output.pieces = std::make_unique<AtomicFolder>(folder, "", vtm_entries(folder));
      }
      if (output.format == Format::plot3d) {
        output.map = std::make_unique<AtomicFile>(fs::path(path).replace_extension(".nmf"));
      }
      continue;
    }
    if (options.flow_case) check_case_folder(output.case_folder);
    output.poly_mesh =
        std::make_unique<AtomicFolder>(output.case_folder, "constant/polyMesh", polymesh_entries());
  }
}

MeshOutputs::~MeshOutputs() = default;
MeshOutputs::MeshOutputs(MeshOutputs&&) noexcept = default;

std::vector<std::string> MeshOutputs::write_curved(Output& output, const CurvedMesh& mesh,
                                                   Progress& progress) {
  if (output.format == Format::vtu) return write_curved_vtu(output.file->stream(), mesh, &progress);
  if (output.format == Format::gmsh) return write_curved_gmsh(output.file->stream(), mesh, &progress);
  return write_curved_cgns(output.file->path(), mesh, {unit_, output.name}, &progress);
}

std::vector<std::string> MeshOutputs::write_linear(Output& output, LinearMesh& of, Progress& progress) {
  const HexView& mesh = of.mesh;
  switch (output.format) {
    case Format::vtu:
      return write_vtu(output.file->stream(), mesh, VtkFields(mesh, of.deviation).fields(), &progress);
    case Format::vtm:
      return write_vtm(output.file->stream(), *output.pieces, vtm_folder(output.name).filename().string(),
                       of.blocks.mesh(), of.blocks.merged(), VtkFields(mesh, of.deviation).fields(),
                       &progress);
    case Format::cgns: {
      const CgnsSettings settings{unit_, output.name};
      if (unstructured_) return write_cgns_unstructured(output.file->path(), mesh, settings, &progress);
      return write_cgns(output.file->path(), of.blocks.mesh(), of.blocks.merged(), settings, &progress);
    }
    case Format::plot3d:
      write_plot3d(output.file->stream(), of.blocks.mesh(), of.blocks.merged(), &progress);
      return write_neutral_map(output.map->stream(), of.blocks.mesh(), of.blocks.merged());
    case Format::gmsh:
      return write_gmsh(output.file->stream(), mesh, &progress);
    case Format::su2:
      return write_su2(output.file->stream(), mesh, &progress);
    case Format::foam_file:
    case Format::folder:
      break;
  }
  if (!of.adjacency) of.adjacency = build_hex_adjacency(mesh);
  if (flow_) output.case_files = foam_case_files(mesh, *flow_);
  return write_polymesh(*output.poly_mesh, mesh, *of.adjacency, {}, &progress);
}

void MeshOutputs::write(const HexView& mesh, const std::vector<double>& deviation, Progress& progress,
                        const CurvedMesh* curved) {
  std::set<std::string> said;  // every format carries the same names, so they have the same notes
  LinearMesh linear{mesh, deviation, {}, BlocksOnDemand(mesh)};
  for (Output& output : outputs_) {
    const std::vector<std::string> notes =
        curved ? write_curved(output, *curved, progress) : write_linear(output, linear, progress);
    for (const std::string& note : notes) {
      if (said.insert(note).second) progress.warn(note);
    }
  }
}

void MeshOutputs::commit() {
  for (Output& output : outputs_) {
    if (output.pieces) output.pieces->commit();  // before the file that names them
    if (output.file) output.file->commit();
    if (output.map) output.map->commit();
    if (output.poly_mesh) {
      output.poly_mesh->commit();
      write_foam_case(output.case_folder, output.case_files);
      write_case_files(output.case_folder, output.foam_file);
    }
  }
}

}  // namespace flowcage
