#pragma once
#include <string>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// What the linter found in a cage under one rule (docs/cages.md lists the rules). What makes a cage unusable
/// is no finding: it is thrown as Error(input).
struct LintFinding {
  enum class Severity : std::uint8_t {
    mended,  ///< put right in the cage that is used from here on; the file stays as it is
    warning  ///< left as drawn: the fit will be poorer there
  };
  std::string rule;  ///< its name in docs/cages.md, "crease_sector"
  Severity severity = Severity::warning;
  std::string message;  ///< one line with the number and the worst place
  std::string remedy;
  std::vector<Vec3> places;  ///< all of them, the worst first
};

using LintReport = std::vector<LintFinding>;

}  // namespace flowcage
