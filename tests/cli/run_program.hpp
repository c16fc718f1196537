#pragma once
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace flowcage {

/// What a run of the real program gave.
struct ProgramRun {
  int exit_code = -1;  ///< 128 + number if a signal ended it
  std::string out, err;
  double seconds = 0;
};

struct RunSettings {
  std::filesystem::path folder{};  ///< working folder
  int signal = 0;                  ///< sent after signal_delay seconds
  double signal_delay = 0;
  double timeout = 120;       ///< seconds until it is killed
  std::string stdout_file{};  ///< instead of capturing it
  long file_limit = -1;       ///< bytes: largest file that it may write; -1: none
  long memory_limit = -1;     ///< bytes of its address space; -1: none
  bool unprivileged = false;  ///< as user nobody where the tests run as root, whom no permission stops
};

/// Runs flowcage with these arguments and waits for it.
ProgramRun run_flowcage(const std::vector<std::string>& arguments, const RunSettings& settings = {});

/// A fresh working folder that vanishes at the end.
class WorkFolder {
 public:
  WorkFolder();
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void put(const std::string& name, const std::string& text) const;
  std::string text_of(const std::string& name) const;
  /// Names of all entries, hidden ones included, sorted.
  std::vector<std::string> entries() const;

 private:
  std::filesystem::path path_;
};

}  // namespace flowcage
