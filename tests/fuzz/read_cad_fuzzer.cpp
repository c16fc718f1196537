// libFuzzer target: any bytes as a CAD file. Whatever they are, read_cad returns a model or throws an Error;
// what the kernel does to its child process costs one input.
//   cmake --preset release -DCMAKE_CXX_COMPILER=clang++ -DFLOWCAGE_FUZZ=ON
//   build/release/bin/fuzz_read_cad CORPUS -max_len=65536
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "occ_bridge/cad_model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int memory = ::memfd_create("cad", 0);
  if (memory < 0 || ::write(memory, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::string file = "/proc/self/fd/" + std::to_string(memory);
  flowcage::CadReadSettings settings;
  settings.time_limit_seconds = 5;
  flowcage::Progress silent;
  try {
    const flowcage::CadModel model = flowcage::read_cad({&file, 1}, settings, silent);
    if (model.face_count() == 0 || !model.bounds().diagonal().allFinite()) std::abort();
  } catch (const flowcage::Error& error) {
    if (error.kind() != flowcage::ErrorKind::input) std::abort();
  }
  ::close(memory);
  return 0;
}
