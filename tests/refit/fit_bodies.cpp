#include "tests/refit/fit_bodies.hpp"

#include <cmath>
#include <functional>
#include <stdexcept>

#include "occ_bridge/shapes.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

namespace flowcage::test {
namespace {

CadModel model_of(const Shape& shape) {
  Progress silent;
  return cad_model_of(shape, {}, silent);
}

HalfWing half_wing(const WingCageShape& cage) {
  HalfWing wing;
  wing.airfoil = naca_symmetric(cage.thickness, cage.half_base);
  wing.root_chord = cage.root_chord;
  wing.tip_chord = cage.tip_chord;
  wing.semi_span = cage.semi_span;
  wing.leading_edge_sweep_degrees = cage.sweep_degrees;
  if (cage.rounded_tip) wing.tip = WingTip::rounded;
  return wing;
}

FitBody wing_body(const std::string& name, double half_base) {
  WingCageShape cage;
  cage.half_base = half_base;
  return {name, model_of(make_half_wing(half_wing(cage))), wing_cage(cage), {2e-5, 5e-6, 1.2e-6}};
}

FitBody rounded_tip_body(const std::string& name, double half_base) {
  WingCageShape cage;
  cage.half_base = half_base;
  cage.rounded_tip = true;
  return {name, model_of(make_half_wing(half_wing(cage))), wing_cage(cage), {4e-4, 2.5e-4, 1.5e-4}};
}

FitBody winged_fuselage_body(const std::string& name) {
  const WingedFuselageShape shape;
  HalfWing wing;
  wing.airfoil = naca_symmetric(shape.thickness, 0);
  wing.root_chord = shape.root_chord;
  wing.tip_chord = shape.tip_chord;
  wing.semi_span = shape.semi_span;
  wing.leading_edge_sweep_degrees = shape.sweep_degrees;
  wing.closed_root = true;
  const Shape solid = make_union(make_ellipsoid(shape.half_length, shape.radius),
                                 translated(make_half_wing(wing), Vec3(shape.wing_x, 0, 0)));
  return {name, model_of(make_half(solid, 1)), winged_fuselage_cage(shape), {2e-3, 5e-4, 1e-4}};
}

/// Half bodies whose figures have to be those of the whole ones.
FitBody half_sphere_body(const std::string& name) {
  return {name, model_of(make_half(make_sphere(0.5), 0)), half_box_cage(0.35), {5e-5, 1e-5, 2e-6}};
}

FitBody half_torus_body(const std::string& name) {
  return {
      name, model_of(make_half(make_torus(1, 0.35), 1)), half_torus_cage(1, 0.4, 4, 4), {1e-4, 5e-6, 3e-7}};
}

struct Maker {
  std::string name;
  std::function<FitBody(const std::string&)> make;
};

const std::vector<Maker>& makers() {
  static const std::vector<Maker> all{
      {"sphere",
       [](const std::string& name) {
         return FitBody{name,
                        model_of(make_sphere(0.5)),
                        box_cage(Vec3::Constant(-0.35), Vec3::Constant(0.35), false),
                        {5e-5, 1e-5, 2e-6}};
       }},
      {"torus",
       [](const std::string& name) {
         return FitBody{name, model_of(make_torus(1, 0.35)), torus_cage(1, 0.4, 4, 4), {1e-4, 5e-6, 3e-7}};
       }},
      {"cylinder",
       [](const std::string& name) {
         return FitBody{name, model_of(make_cylinder(1, 1)), cylinder_cage(1, 1), {7e-6, 4e-7, 3e-8}};
       }},
      {"wing_sharp", [](const std::string& name) { return wing_body(name, 0); }},
      {"wing_blunt", [](const std::string& name) { return wing_body(name, 0.0025); }},
      {"wing_thin_base", [](const std::string& name) { return wing_body(name, 0.0005); }},
      {"wing_round_tip_blunt", [](const std::string& name) { return rounded_tip_body(name, 0.0005); }},
      {"rounded_box",
       [](const std::string& name) {
         const Vec3 half(0.6, 0.5, 0.4);
         return FitBody{name,
                        model_of(make_rounded_box(2 * half, 0.2)),
                        box_cage(-half, half, false),
                        {5e-3, 1e-3, 3e-4}};
       }},
      {"cone",
       [](const std::string& name) {
         return FitBody{name, model_of(make_cone(1, 2)), cone_cage(1, 2), {1e-4, 5e-5, 2.5e-5}};
       }},
      {"fading_ridge",
       [](const std::string& name) {
         return FitBody{name, model_of(make_fading_ridge()), ridge_cage(0.3), {1e-3, 5e-4, 2.5e-4}};
       }},
      {"wing_fuselage", winged_fuselage_body},
      {"half_sphere", half_sphere_body},
      {"half_torus", half_torus_body},
  };
  return all;
}

}  // namespace

std::vector<std::string> fit_body_names() {
  std::vector<std::string> names;
  for (const Maker& maker : makers()) names.push_back(maker.name);
  return names;
}

FitBody make_fit_body(const std::string& name) {
  for (const Maker& maker : makers()) {
    if (maker.name == name) return maker.make(name);
  }
  throw std::invalid_argument("no body is called " + name);
}

}  // namespace flowcage::test
