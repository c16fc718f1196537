#include "cli/commands/commands.hpp"
#include "cli/mesh_outputs.hpp"
#include "core/export/read_mesh.hpp"

namespace flowcage {

int run_convert(const Options& options, Progress& progress) {
  MeshOutputs outputs(options);
  progress.step("read", 0);
  const HexMesh mesh = read_mesh(options.inputs.front());
  outputs.write(mesh, {}, progress);
  outputs.commit();
  return 0;
}

}  // namespace flowcage
