#include "tests/blocks/ambient_bodies.hpp"

#include <map>
#include <stdexcept>

namespace flowcage::test {
namespace {

struct Body {
  Shape shape;
  bool internal = false;
  Index genus = 0, parts = 1;
};

Body wing(bool blunt) {
  HalfWing wing;
  wing.airfoil = naca_symmetric(0.12, blunt ? 0.005 : 0);
  return {make_half_wing(wing)};
}

Body build(const std::string& name) {
  if (name == "sphere") return {make_sphere(1)};
  if (name == "torus") return {make_torus(1, 0.4), false, 1};
  if (name == "box") return {make_box({1, 0.8, 0.6})};
  if (name == "rounded_box") return {make_rounded_box({1, 0.8, 0.6}, 0.15)};
  if (name == "cylinder") return {make_cylinder(0.5, 1)};
  if (name == "bracket") {
    const Shape angle =
        make_difference(make_box({2, 1, 2}), translated(make_box({2, 1.2, 2}), {0.6, 0, 0.6}));
    const Shape hole = translated(make_cylinder(0.25, 2), {0.35, 0, -1.5});
    return {make_difference(angle, hole), false, 1};
  }
  if (name == "capsule") {
    return {make_union(make_union(make_cylinder(0.5, 1.5), make_sphere(0.5)),
                       translated(make_sphere(0.5), {0, 0, 1.5}))};
  }
  if (name == "wing_sharp") return wing(false);
  if (name == "wing_blunt") return wing(true);
  if (name == "two_bodies")
    return {make_compound(make_sphere(0.5), translated(make_box({0.8, 0.8, 0.8}), {2, 0.3, 0})), false, 0, 2};
  if (name == "wing_body_fused" || name == "wing_body_overlapping") {
    HalfWing half;
    half.airfoil = naca_symmetric(0.12, 0.005);
    half.closed_root = true;
    const Shape wing = translated(make_half_wing(half), {-0.5, 0.1, 0});
    if (name == "wing_body_overlapping") return {make_compound(make_ellipsoid(2.5, 0.35), wing)};
    return {make_half(make_union(make_ellipsoid(2.5, 0.35), wing), 1)};
  }
  if (name == "elbow") {
    const Shape bend = make_bend(1, 0.3, 90);
    const Shape in = translated(rotated(make_cylinder(0.3, 1), {1, 0, 0}, 90), {1, 0, 0});
    const Shape out = translated(rotated(make_cylinder(0.3, 1), {0, 1, 0}, -90), {0, 1, 0});
    return {make_union(make_union(in, bend), out), true};
  }
  if (name == "tee") {
    const Shape run = translated(rotated(make_cylinder(0.3, 3), {0, 1, 0}, 90), {-1.5, 0, 0});
    return {make_union(run, make_cylinder(0.25, 1.2)), true};
  }
  if (name == "channel")
    return {make_difference(make_box({4, 1.5, 1.5}), translated(make_box({0.6, 0.5, 0.5}), {-0.5, 0, 0})),
            true, 0, 2};
  throw std::logic_error("no such body: " + name);
}

}  // namespace

std::vector<std::string> ambient_body_names() {
  return {"sphere",  "torus",      "box",        "rounded_box", "cylinder",        "bracket",
          "capsule", "wing_sharp", "wing_blunt", "two_bodies",  "wing_body_fused", "wing_body_overlapping",
          "elbow",   "tee",        "channel"};
}

AmbientTestBody make_ambient_body(const std::string& name) {
  const Body body = build(name);
  Progress silent;
  return {cad_model_of(body.shape, {}, silent), body.internal, body.genus, body.parts};
}

}  // namespace flowcage::test
