#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/hex_view.hpp"
#include "core/options.hpp"

namespace flowcage {

/// The outputs (-o) of a command that writes volume meshes, one format each by its name: files and folders
/// that appear together, at commit, or not at all.
class MeshOutputs {
 public:
  /// Throws Error(usage) for a name that is no mesh format: to be called before long work.
  static void check_formats(const std::vector<std::string>& names);

  /// Opens every output, so that a place that cannot be written shows at once. Throws Error(output), and as
  /// check_formats.
  explicit MeshOutputs(const Options& options);
  ~MeshOutputs();
  MeshOutputs(MeshOutputs&&) noexcept;

  /// Writes every output: the structured formats with the blocks of a BlockMesh, merged; of another mesh the
  /// cells are merged to blocks. `deviation` is a field on the points, or empty. Notes go to progress.warn,
  /// each once. Throws Error(output).
  void write(const HexView& mesh, const std::vector<double>& deviation, Progress& progress);
  /// All were written: only now any of them appears. Throws Error(output).
  void commit();

 private:
  struct Output;
  std::string unit_;
  bool unstructured_;
  std::vector<Output> outputs_;
};

}  // namespace flowcage
