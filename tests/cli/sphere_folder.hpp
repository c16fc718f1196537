// A sphere of diameter 1 m as CAD and a cube as its cage, in a fresh folder; both files' and patches' names
// can be chosen.
#pragma once
#include <sstream>

#include "occ_bridge/shapes.hpp"
#include "tests/cli/run_program.hpp"

namespace flowcage::tests {

class SphereFolder : public WorkFolder {
 public:
  explicit SphereFolder(std::string file = "sphere.step", const std::string& patch = "ball")
      : file_(std::move(file)) {
    write_cad(make_sphere(0.5), (path() / file_).string(), "m");
    std::ostringstream cage;
    for (int i = 0; i < 8; ++i) {
      cage << "v " << (i % 2 != 0 ? .45 : -.45) << ' ' << (i / 2 % 2 != 0 ? .45 : -.45) << ' '
           << (i / 4 != 0 ? .45 : -.45) << '\n';
    }
    cage << "g " << patch << "\nf 1 3 4 2\nf 5 6 8 7\nf 3 7 8 4\ng plain\nf 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\n";
    put("cage.obj", cage.str());
  }
  ProgramRun run(const char* command, const std::vector<std::string>& rest) const {
    std::vector<std::string> arguments{command, file_, "--cage", "cage.obj"};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    return run_flowcage(arguments, {.folder = path()});
  }

 private:
  std::string file_;
};

}  // namespace flowcage::tests
