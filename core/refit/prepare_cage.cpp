#include "core/refit/prepare_cage.hpp"

#include <fmt/format.h>

#include <iterator>

#include "core/cage/face_crossings.hpp"
#include "core/cage/lint_cage.hpp"
#include "core/project/find_creases.hpp"
#include "core/project/split_at_bends.hpp"
#include "core/refit/cage_check.hpp"
#include "core/refit/cage_topology.hpp"
#include "core/refit/tag_tips.hpp"

namespace flowcage {
namespace {

class Linter {
 public:
  Linter(PreparedCage& prepared, Progress& progress) : prepared_(prepared), progress_(progress) {}

  void add(const LintReport& findings) {
    for (const LintFinding& finding : findings) {
      const bool mended = finding.severity == LintFinding::Severity::mended;
      progress_.warn(fmt::format("cage: {} [{}]: {}", finding.message, finding.rule,
                                 mended ? "mended; in the file: " + finding.remedy : finding.remedy));
      prepared_.lint.push_back(finding);
    }
  }

 private:
  PreparedCage& prepared_;
  Progress& progress_;
};

}  // namespace

PreparedCage prepare_cage(Cage cage, const TargetSurface& target, const PrepareSettings& settings,
                          Progress& progress) {
  PreparedCage prepared;
  Linter lint(prepared, progress);
  progress.step("cage", 0);
  TurnedCage turned = turn_parts_outside(cage, target);
  lint.add(turned.findings);
  prepared.cage = std::move(turned.cage);
  check_cage_belongs(prepared.cage, target);
  lint.add(lint_cage_topology(prepared.cage, target));

  if (!prepared.cage.creases.empty()) {
    prepared.creases = PreparedCage::Creases::drawn;
  } else {
    FoundCreases found = find_creases(prepared.cage, target);
    if (found.crease_edges > 0) {
      prepared.creases = PreparedCage::Creases::found;
      progress.warn(
          fmt::format("the cage has no creases: {} of its edges were made creases along {} of the CAD's {} "
                      "chains of sharp "
                      "edges, {} vertices corners (tags in the cage file overrule this)",
                      found.crease_edges, found.followed, found.sharp_chains, found.corners.size()));
    }
    for (const std::string& warning : found.warnings) progress.warn(warning);
    prepared.cage = std::move(found.cage);
  }
  TaggedTips tipped = tag_tips(prepared.cage, target);
  lint.add(tipped.findings);
  prepared.cage = std::move(tipped.cage);
  lint.add(lint_face_crossings(prepared.cage));
  lint.add(lint_cage_shape(prepared.cage));  // lines end at creases
  SplitSectors split = split_crease_sectors(prepared.cage, settings.new_faces);
  if (!split.findings.empty()) {
    split = split_crease_sectors(prepared.cage, settings.new_faces, vertices_at_bends(prepared.cage, target));
  }
  lint.add(split.findings);
  prepared.cage = std::move(split.cage);
  return prepared;
}

}  // namespace flowcage
