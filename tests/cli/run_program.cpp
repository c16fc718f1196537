#include "tests/cli/run_program.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace flowcage {
namespace fs = std::filesystem;
namespace {

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path fresh_name() {
  static std::atomic<int> counter{0};
  return fs::temp_directory_path() /
         ("flowcage_cli_" + std::to_string(::getpid()) + "_" + std::to_string(counter++));
}

void limit(__rlimit_resource_t what, long value) {
  if (value < 0) return;
  const rlimit both{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  if (::setrlimit(what, &both) != 0) ::_exit(125);
}

[[noreturn]] void become_program(const std::vector<std::string>& arguments, const RunSettings& settings,
                                 const fs::path& out, const fs::path& err) {
  const int out_fd = ::open(out.c_str(), O_WRONLY | O_CREAT, 0600);
  const int err_fd = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
  ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
  ::dup2(out_fd, STDOUT_FILENO);
  ::dup2(err_fd, STDERR_FILENO);
  if (!settings.folder.empty() && ::chdir(settings.folder.c_str()) != 0) ::_exit(126);
  limit(RLIMIT_FSIZE, settings.file_limit);
  limit(RLIMIT_AS, settings.memory_limit);
  constexpr uid_t nobody = 65534;
  if (settings.unprivileged && ::geteuid() == 0 && (::setgid(nobody) != 0 || ::setuid(nobody) != 0)) {
    ::_exit(124);
  }
  std::vector<char*> argv{const_cast<char*>("flowcage")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  ::execv(FLOWCAGE_PROGRAM, argv.data());
  ::_exit(127);
}

}  // namespace

ProgramRun run_flowcage(const std::vector<std::string>& arguments, const RunSettings& settings) {
  const fs::path name = fresh_name();
  const fs::path captured = name.string() + ".out", err = name.string() + ".err";
  const fs::path out = settings.stdout_file.empty() ? captured : fs::path(settings.stdout_file);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) become_program(arguments, settings, out, err);

  bool signalled = settings.signal == 0;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (!signalled && elapsed() > settings.signal_delay) {
      ::kill(child, settings.signal);
      signalled = true;
    }
    if (elapsed() > settings.timeout) ::kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ProgramRun run;
  run.seconds = elapsed();
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.out = content(captured);
  run.err = content(err);
  fs::remove(captured);
  fs::remove(err);
  return run;
}

WorkFolder::WorkFolder() : path_(fresh_name()) {
  fs::create_directory(path_);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void WorkFolder::put(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
}

std::string WorkFolder::text_of(const std::string& name) const {
  return content(path_ / name);
}

std::vector<std::string> WorkFolder::entries() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace flowcage
