#pragma once
#include <string_view>

#include "core/base/error.hpp"

namespace flowcage {

/// How core tells a caller what it does: core itself never prints. The default object is silent and never
/// cancels.
class Progress {
 public:
  virtual ~Progress() = default;
  /// `stage` is a short phrase ("fit, level 3"); `fraction` of that stage in [0, 1].
  virtual void report(std::string_view stage, double fraction);
  /// A sentence for the user that is no error ("cage has no creases: ...").
  virtual void warn(std::string_view message);
  /// True once the user asked to stop.
  virtual bool cancelled() const;

  /// Reports, and throws Error(interrupted) when the user asked to stop. Long loops call it often.
  void step(std::string_view stage, double fraction) {
    if (cancelled()) throw Error(ErrorKind::interrupted, "interrupted", "nothing was written");
    report(stage, fraction);
  }
};

inline void Progress::report(std::string_view, double) {}
inline void Progress::warn(std::string_view) {}
inline bool Progress::cancelled() const {
  return false;
}

}  // namespace flowcage
