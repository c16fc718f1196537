#pragma once
#include <stdexcept>
#include <string>

#include "core/base/types.hpp"

namespace flowcage {

/// What went wrong, as the program's exit codes name it (docs/limits.md, exit codes).
enum class ErrorKind {
  usage = 2,         ///< wrong option or value
  input = 3,         ///< an input cannot be read or is not usable
  gate = 4,          ///< a result was made but misses a gate
  output = 5,        ///< cannot write
  internal = 70,     ///< a defect of flowcage
  interrupted = 130  ///< the user or a signal stopped the work
};

/// Thrown when an input is unusable or no valid result exists. A numerical outcome (12 poor cells) is no
/// error: it is data in a report. `what()` is one line that names the value and the place; `remedy()` says
/// what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& what, std::string remedy);

  ErrorKind kind() const { return kind_; }
  const std::string& remedy() const { return remedy_; }

 private:
  ErrorKind kind_;
  std::string remedy_;
};

/// "FILE:LINE: WHAT" (line 0: "FILE: WHAT"); the file as the user gave it.
[[nodiscard]] Error input_error(const std::string& file, long line, const std::string& what,
                                std::string remedy);

/// "(x, y, z)" with six significant digits: how every message gives a place.
std::string place(const Vec3& p);

}  // namespace flowcage
