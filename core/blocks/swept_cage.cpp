#include "core/blocks/swept_cage.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace flowcage {
namespace {

constexpr double front_fraction = 0.2, rear_fraction = 0.65, base_fraction = 0.97;

/// (u, w) of a coarse vertex of the plan in a section.
Vec2 section_point(const AirfoilSection& section, const SweptPlan& plan, Index vertex) {
  const Vec2 along = section.trailing - section.leading;
  const auto side = [&](double fraction, int which) {
    const auto sides = section.across(fraction);
    return sides ? (*sides)[which] : Vec2(section.leading + fraction * along);
  };
  const auto camber = [&](double fraction) { return Vec2((side(fraction, 0) + side(fraction, 1)) / 2); };
  if (vertex == plan.front) return camber(front_fraction);
  if (vertex == plan.rear) return camber(0.92 * rear_fraction);
  switch (vertex) {
    case 0:
      return section.base_upper;
    case 1:
      return side(rear_fraction, 0);
    case 2:
      return side(front_fraction, 0);
    case 3:
      return section.leading;
    case 4:
      return side(front_fraction, 1);
    case 5:
      return side(rear_fraction, 1);
    case 6:
      return section.base_lower;
    default:
      return section.trailing;
  }
}

class Maker {
 public:
  Maker(const TargetSurface& target, const SweptBody& body, const SweptPlan& plan)
      : target_(target), body_(body), plan_(plan) {
    out_.cage.patch_names = {""};
  }

  SweptCage make() {
    const auto sections = static_cast<Index>(body_.sections.size());
    for (Index n = 0; n < sections; ++n) {
      for (Index v = 0; v < plan_.ring; ++v) add({n, v}, section_point(body_.sections[n], plan_, v));
    }
    for (Index n = 0; n + 1 < sections; ++n) {
      for (Index v = 0; v < plan_.ring; ++v) {
        const Index next = (v + 1) % plan_.ring;
        face({at(n, v), at(n + 1, v), at(n + 1, next), at(n, next)});
      }
      trailing_creases(n);
    }
    if (body_.ends[0] != SweptEnd::open) cap(0, 0);
    if (body_.ends[1] != SweptEnd::open) cap(1, sections - 1);
    return std::move(out_);
  }

 private:
  Index at(Index section, Index vertex) const { return number_.at({section, vertex}); }

  void add(const SweptPlace& place, const Vec2& p) {
    number_[{place.section, place.vertex}] = static_cast<Index>(out_.places.size());
    out_.places.push_back(place);
    out_.cage.points.push_back(body_.axes.place(p.x(), body_.sections[place.section].s, p.y()));
  }
  void face(const std::vector<Index>& corners) {
    out_.cage.faces.push_row(corners);
    out_.cage.face_patch.push_back(0);
  }
  void crease(Index a, Index b) { out_.cage.creases.push_back({a, b, infinitely_sharp}); }

  void trailing_creases(Index n) {
    const auto has = [&](TrailingEdge kind) {
      return body_.sections[n].kind == kind && body_.sections[n + 1].kind == kind;
    };
    if (plan_.trailing == TrailingEdge::round || !has(plan_.trailing)) return;
    crease(at(n, 0), at(n + 1, 0));
    if (plan_.trailing == TrailingEdge::blunt) crease(at(n, 6), at(n + 1, 6));
  }

  /// The plug's polygons; seen from the fluid they turn against the plan at the far end of the span.
  void cap(int end, Index section) {
    for (const Index v : {plan_.front, plan_.rear}) {
      add({section, v}, section_point(body_.sections[section], plan_, v));
      if (body_.ends[end] == SweptEnd::rounded) push_out(end, out_.cage.points.back());
    }
    for (const auto& polygon : plan_.plug) {
      std::vector<Index> corners;
      for (const Index v : polygon) corners.push_back(at(section, v));
      if (end == 1) std::reverse(corners.begin(), corners.end());
      face(corners);
    }
    if (body_.ends[end] == SweptEnd::flat) {
      for (Index v = 0; v < plan_.ring; ++v) crease(at(section, v), at(section, (v + 1) % plan_.ring));
    } else if (plan_.trailing == TrailingEdge::sharp) {
      out_.cage.corners.push_back({at(section, 0), infinitely_sharp});
    }
  }

  /// The camber point of a rounded end, on the CAD along the span.
  void push_out(int end, Vec3& p) const {
    const Vec3 out = (end == 0 ? -1 : 1) * body_.axes.span;
    SurfacePoint hit;
    target_.intersect_lines({&p, 1}, {&out, 1}, 0, 0.2 * target_.diagonal(), {&hit, 1});
    if (hit.status != FootStatus::failed) p = hit.position;
  }

  const TargetSurface& target_;
  const SweptBody& body_;
  const SweptPlan& plan_;
  SweptCage out_;
  std::map<std::pair<Index, Index>, Index> number_;
};

}  // namespace

SweptCage make_swept_cage(const TargetSurface& target, const SweptBody& body, const SweptPlan& plan) {
  return Maker(target, body, plan).make();
}

}  // namespace flowcage
