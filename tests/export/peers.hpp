#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace flowcage::tests {

/// What another program said: everything it printed, and its exit code.
struct PeerRun {
  std::string output;
  int exit_code = 0;
};
PeerRun run(const std::string& command);

/// Whether a program is on the path (or `module` importable by /usr/bin/python3); prints a line if not, so
/// that a skipped check is seen.
bool have_program(const std::string& name);
bool have_python_module(const std::string& module);

/// A new empty folder under the system's temporary one; removed with the object.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// checkMesh's figures by the words before them ("Max skewness", "Mesh non-orthogonality Max", ...).
struct CheckMesh {
  std::string output;
  bool mesh_ok = false;
  std::map<std::string, double> figures;
};
CheckMesh check_mesh(const std::filesystem::path& folder);

std::string read_text(const std::filesystem::path& file);

}  // namespace flowcage::tests
