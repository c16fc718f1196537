#pragma once
#include "core/base/progress.hpp"
#include "core/cage/lint_report.hpp"
#include "core/mesh/cage.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

struct PrepareSettings {
  bool new_faces = true;  ///< faces may be split; not where an outer polyhedron has to have the same faces
};

/// A drawn cage made ready for the fit.
struct PreparedCage {
  enum class Creases : std::uint8_t { drawn, found, none };
  Cage cage;
  Creases creases = Creases::none;
  LintReport lint;
};

/// Lints a cage against the target, mends what can be mended safely and finds its creases:
/// parts turned inside out are reversed (rule "inside_out"); a cage of a wrong unit, too far away or of
/// another genus is refused; a cage without any crease gets those along the target's sharp edges
/// (find_creases.hpp); vertices at the target's tips become corners (tag_tips.hpp); then the rules of
/// lint_cage.hpp. Everything found is in `lint`, and in a sentence each
/// given to progress.warn, as is what find_creases says. Throws Error(input) for a cage that cannot be used.
PreparedCage prepare_cage(Cage cage, const TargetSurface& target, const PrepareSettings& settings,
                          Progress& progress);

}  // namespace flowcage
