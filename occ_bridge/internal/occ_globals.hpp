#pragma once
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace flowcage {

/// Interface_Static and the readers' sessions are process-wide: whoever reads or writes a file holds this
/// lock.
std::mutex& occ_globals_mutex();

/// Takes OpenCASCADE's printers away: stdout carries only what was asked for, errors are ours to word.
void silence_occ();

/// Sets string parameters of Interface_Static (name, value) for its lifetime and restores the old ones.
/// Precondition: the caller holds occ_globals_mutex().
class InterfaceSettings {
 public:
  explicit InterfaceSettings(std::vector<std::pair<std::string, std::string>> values);
  ~InterfaceSettings();
  InterfaceSettings(const InterfaceSettings&) = delete;
  InterfaceSettings& operator=(const InterfaceSettings&) = delete;

 private:
  std::vector<std::pair<std::string, std::string>> old_;
};

}  // namespace flowcage
