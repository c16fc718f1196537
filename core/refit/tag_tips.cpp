#include "core/refit/tag_tips.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/project/tip_vertices.hpp"

namespace flowcage {

TaggedTips tag_tips(const Cage& cage, const TargetSurface& target) {
  const std::vector<Vec3>& tips = target.features().tips;
  TaggedTips result{cage, {}};
  if (tips.empty()) return result;
  const SurfaceLevel level = build_surface_level(cage);
  const std::vector<Index> vertices = tip_vertices(level, cage.points, tips);
  LintFinding made{"tip", LintFinding::Severity::mended, {}, "tag the vertex as a corner", {}};
  LintFinding missed{"tip",
                     LintFinding::Severity::warning,
                     {},
                     "draw a vertex of the cage there, closer than half of its edges, and tag it as a corner",
                     {}};
  for (std::size_t t = 0; t < tips.size(); ++t) {
    if (vertices[t] == no_index) {
      missed.places.push_back(tips[t]);
    } else if (level.vertex_sharpness[vertices[t]] < infinitely_sharp) {
      made.places.push_back(tips[t]);
      result.cage.corners.push_back({vertices[t], infinitely_sharp});
    }
  }
  const auto say = [&](LintFinding& finding, const char* what) {
    if (finding.places.empty()) return;
    finding.message = fmt::format("{} tip{} of the CAD (at {}): {}", finding.places.size(),
                                  finding.places.size() > 1 ? "s" : "", place(finding.places[0]), what);
    result.findings.push_back(std::move(finding));
  };
  say(made, "the vertex of the cage there was made a corner");
  say(missed, "no vertex of the cage is near, the surface will be rounded there");
  return result;
}

}  // namespace flowcage
