#include "tests/export/peers.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace flowcage::tests {

PeerRun run(const std::string& command) {
  PeerRun result;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot start: " + command);
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    result.output.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return result;
}

bool have_program(const std::string& name) {
  const bool found = run("command -v " + name).exit_code == 0;
  if (!found) std::cout << "skipped: " << name << " is not installed\n";
  return found;
}

bool have_python_module(const std::string& module) {
  const bool found = run("/usr/bin/python3 -c 'import " + module + "'").exit_code == 0;
  if (!found) std::cout << "skipped: python3 has no " << module << "\n";
  return found;
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "flowcage-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("cannot make " + name);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

CheckMesh check_mesh(const std::filesystem::path& folder) {
  CheckMesh result;
  result.output = run("WM_PROJECT_DIR=/usr/share/openfoam checkMesh -case '" + folder.string() + "'").output;
  result.mesh_ok = result.output.find("\nMesh OK.") != std::string::npos;
  const std::string number = "[-+0-9.e]*[0-9]";
  const std::regex figure("([A-Za-z][A-Za-z -]*[A-Za-z])\\s*[:=]\\s*(" + number + ")");
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);) {
    for (std::sregex_iterator it(line.begin(), line.end(), figure), end; it != end; ++it) {
      result.figures.emplace((*it)[1], std::stod((*it)[2]));
    }
  }
  return result;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace flowcage::tests
