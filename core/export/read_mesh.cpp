#include "core/export/read_mesh.hpp"

#include "core/base/error.hpp"
#include "core/export/file_text.hpp"

namespace flowcage {

HexMesh read_mesh(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::string extension = lower_extension(path);
  if (extension == ".foam" || std::filesystem::is_directory(path, ignored)) return read_polymesh(path);
  if (extension == ".vtu") return read_vtu(path);
  if (extension == ".vtm") return read_vtm(path);
  if (extension == ".cgns") return read_cgns(path);
  if (extension == ".msh") return read_gmsh(path);
  if (extension == ".su2") return read_su2(path);
  if (!std::filesystem::exists(path, ignored)) {
    throw input_error(path.string(), 0, "no such file or folder", "check the name");
  }
  throw input_error(path.string(), 0, "is no mesh format that flowcage reads",
                    "give a .vtu, .vtm, .cgns, .msh or .su2 file, an OpenFOAM case folder, or a .foam file");
}

}  // namespace flowcage
