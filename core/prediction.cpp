#include "core/prediction.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/refit/fit_surface.hpp"

namespace flowcage {

double available_memory() {
  const double machine =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return machine;
  return std::min(machine, static_cast<double>(limit.rlim_cur));
}

double Prediction::memory_bytes() const {
  constexpr double program = 80e6;
  const double fit = 20e3 * faces;
  const double volume = 4e3 * faces + 90 * cells;
  return program + std::max(fit, volume) + 800 * samples;
}

bool Prediction::fits() const {
  constexpr double most_points = 2e9;  // an Index numbers them
  return memory_bytes() <= available_memory() && std::max(cells, samples) < most_points;
}

Prediction affordable_levels(const FitSettings& fit, int least, const std::string& cage_name,
                             const std::function<Prediction(int level)>& at_level) {
  const int given = std::max(fit.levels, least);
  int most = given;
  while (most > least && !at_level(most).fits()) --most;
  const bool asked = fit.tolerance <= 0;
  Prediction needed = at_level(asked ? given : most);
  needed.levels = asked ? given : most;
  needed.at_most = !asked && most > least;
  if (needed.fits()) return needed;
  std::string makes = fmt::format("{:.3g} faces", needed.faces);
  if (needed.cells > 0) makes += fmt::format(" and {:.3g} cells", needed.cells);
  if (needed.samples > 0) makes += fmt::format(" in {:.3g} samples", needed.samples);
  throw Error(
      ErrorKind::usage,
      fmt::format(
          "--levels: {} level(s) of {} make {}, about {:.3g} GB: more than this machine holds ({:.3g} GB)",
          needed.levels, cage_name, makes, needed.memory_bytes() / 1e9, available_memory() / 1e9),
      at_level(most).fits() ? fmt::format("ask for fewer: {} level(s) fit", most)
                            : std::string("give a coarser cage or a larger machine"));
}

}  // namespace flowcage
