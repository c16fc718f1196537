#include "cli/mesh_outputs.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <set>

#include "cli/output_names.hpp"
#include "core/base/atomic_file.hpp"
#include "core/base/error.hpp"
#include "core/export/write_cgns.hpp"
#include "core/export/write_gmsh.hpp"
#include "core/export/write_plot3d.hpp"
#include "core/export/write_polymesh.hpp"
#include "core/export/write_su2.hpp"
#include "core/export/write_vtu.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/quality/jacobian.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

enum class Format { vtu, cgns, plot3d, gmsh, su2, foam_file, folder };
constexpr const char* known_formats =
    "give X.vtu, X.cgns, X.xyz, X.msh, X.su2, X.foam or a folder (with / at its end)";

Format format_of(const std::string& name) {
  const std::string extension = lower_extension(name);
  if (extension == ".vtu") return Format::vtu;
  if (extension == ".cgns") return Format::cgns;
  if (extension == ".xyz" || extension == ".p3d") return Format::plot3d;
  if (extension == ".msh") return Format::gmsh;
  if (extension == ".su2") return Format::su2;
  if (extension == ".foam") return Format::foam_file;
  if (extension.empty() || fs::is_directory(name)) return Format::folder;
  if (extension == ".vtm") {
    throw Error(ErrorKind::usage, fmt::format("-o: {}: the format .vtm is not in this version", name),
                known_formats);
  }
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

}  // namespace

struct MeshOutputs::Output {
  Format format;
  std::string name;
  std::unique_ptr<AtomicFile> file;
  std::unique_ptr<AtomicFile> map;  ///< beside a Plot3D grid
  std::unique_ptr<AtomicFolder> poly_mesh;
  fs::path case_folder;
  std::string foam_file;
};

void MeshOutputs::check_formats(const std::vector<std::string>& names) {
  for (const std::string& name : names) format_of(name);
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
      if (output.format == Format::plot3d) {
        output.map = std::make_unique<AtomicFile>(fs::path(path).replace_extension(".nmf"));
      }
      continue;
    }
    output.poly_mesh =
        std::make_unique<AtomicFolder>(output.case_folder, "constant/polyMesh", polymesh_entries());
  }
}

MeshOutputs::~MeshOutputs() = default;
MeshOutputs::MeshOutputs(MeshOutputs&&) noexcept = default;

void MeshOutputs::write(const HexView& mesh, const std::vector<double>& deviation, Progress& progress) {
  std::set<std::string> said;  // every format carries the same names, so they have the same notes
  std::optional<HexAdjacency> adjacency;
  BlocksOnDemand blocks(mesh);
  for (Output& output : outputs_) {
    std::vector<std::string> notes;
    switch (output.format) {
      case Format::vtu: {
        const std::vector<float> jacobians = scaled_jacobians(mesh);
        const std::vector<float> deviations(deviation.begin(), deviation.end());
        VtuFields fields{{{"scaledJacobian", jacobians, {}}}, {}};
        if (!deviations.empty()) fields.point_fields.push_back({"deviation", deviations});
        notes = write_vtu(output.file->stream(), mesh, fields, &progress);
        break;
      }
      case Format::cgns: {
        const CgnsSettings settings{unit_, output.name};
        if (unstructured_) {
          notes = write_cgns_unstructured(output.file->path(), mesh, settings, &progress);
          break;
        }
        notes = write_cgns(output.file->path(), blocks.mesh(), blocks.merged(), settings, &progress);
        break;
      }
      case Format::plot3d:
        write_plot3d(output.file->stream(), blocks.mesh(), blocks.merged(), &progress);
        notes = write_neutral_map(output.map->stream(), blocks.mesh(), blocks.merged());
        break;
      case Format::gmsh:
        notes = write_gmsh(output.file->stream(), mesh, &progress);
        break;
      case Format::su2:
        notes = write_su2(output.file->stream(), mesh, &progress);
        break;
      case Format::foam_file:
      case Format::folder:
        if (!adjacency) adjacency = build_hex_adjacency(mesh);
        notes = write_polymesh(*output.poly_mesh, mesh, *adjacency, {}, &progress);
        break;
    }
    for (const std::string& note : notes) {
      if (said.insert(note).second) progress.warn(note);
    }
  }
}

void MeshOutputs::commit() {
  for (Output& output : outputs_) {
    if (output.file) output.file->commit();
    if (output.map) output.map->commit();
    if (output.poly_mesh) {
      output.poly_mesh->commit();
      write_case_files(output.case_folder, output.foam_file);
    }
  }
}

}  // namespace flowcage
