#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/curve/curved_mesh.hpp"
#include "core/export/write_foam_case.hpp"
#include "core/mesh/hex_view.hpp"
#include "core/options.hpp"

namespace flowcage {

/// The outputs (-o) of a command that writes volume meshes, one format each by its name: files and folders
/// that appear together, at commit, or not at all.
class MeshOutputs {
 public:
  /// Throws Error(usage) for a name that is no mesh format: to be called before long work.
  static void check_formats(const std::vector<std::string>& names);

  /// Whether one of these names is an OpenFOAM case.
  static bool has_foam_case(const std::vector<std::string>& names);

  /// Whether the format of a name can hold curved cells.
  static bool holds_curved(const std::string& name);

  /// Bytes that a mesh of so many cells takes on the disk in the format of `name`: exact to a few percent for
  /// binary formats, with numbers of usual length for text.
  static double predicted_bytes(const std::string& name, double cells, bool unstructured);

  /// Opens every output, so that a place that cannot be written shows at once. Throws Error(output), and as
  /// check_formats.
  explicit MeshOutputs(const Options& options);
  ~MeshOutputs();
  MeshOutputs(MeshOutputs&&) noexcept;

  /// The OpenFOAM cases shall have all that a flow needs to start (--case).
  void set_flow(const FoamFlow& flow) { flow_ = flow; }

  /// Writes every output: the structured formats with the blocks of a BlockMesh, merged; of another mesh the
  /// cells are merged to blocks. `deviation` is a field on the points, or empty. Notes go to progress.warn,
  /// each once. With `curved`, that mesh is written instead (check_order). Throws Error(output).
  void write(const HexView& mesh, const std::vector<double>& deviation, Progress& progress,
             const CurvedMesh* curved = nullptr);
  /// All were written: only now any of them appears. Throws Error(output).
  void commit();

 private:
  struct Output;
  struct LinearMesh;
  std::vector<std::string> write_linear(Output& output, LinearMesh& of, Progress& progress);
  std::vector<std::string> write_curved(Output& output, const CurvedMesh& mesh, Progress& progress);
  std::string unit_;
  bool unstructured_;
  std::optional<FoamFlow> flow_;
  std::vector<Output> outputs_;
};

}  // namespace flowcage
