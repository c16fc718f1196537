#pragma once
#include <functional>
#include <string>

namespace flowcage {

struct FitSettings;

/// What a job makes at its last level and what that takes of the machine, before the work.
struct Prediction {
  int levels = 0;        ///< of the fit
  bool at_most = false;  ///< the tolerance may be met at an earlier level
  double faces = 0;      ///< of the fitted surface
  double cells = 0;      ///< of the volume, boundary layers included; 0: only a surface
  double samples = 0;    ///< faces of a sampled limit surface

  /// Peak of the process: the fit's systems, or the last level's points and quality figures with what is kept
  /// of the fit. From peaks of spheres (25,000 to 98,000 faces) and a wing, a third on top.
  double memory_bytes() const;
  /// Within the memory of the machine, the process's own limit (ulimit -v) and the numbers of points.
  bool fits() const;
};

/// The machine's memory, or the process's limit of its address space where that is less, bytes.
double available_memory();

/// The levels to do, as a prediction. Asked for (no tolerance), they are done or refused; otherwise they are
/// only a bound, which comes down to what the machine holds, not below `least`. `at_level` gives faces, cells
/// and samples of a level. Throws Error(usage) with numbers where not even that fits.
Prediction affordable_levels(const FitSettings& fit, int least, const std::string& cage_name,
                             const std::function<Prediction(int level)>& at_level);

}  // namespace flowcage
