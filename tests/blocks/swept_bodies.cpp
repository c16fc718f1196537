#include "tests/blocks/swept_bodies.hpp"

#include <functional>
#include <stdexcept>

#include "occ_bridge/shapes.hpp"

namespace flowcage::test {
namespace {

HalfWing half_wing(double half_base, WingTip tip, bool closed_root) {
  HalfWing wing;
  wing.airfoil = naca_symmetric(0.12, half_base);
  wing.tip = tip;
  wing.closed_root = closed_root;
  return wing;
}

const std::vector<std::pair<std::string, std::function<Shape()>>>& bodies() {
  static const std::vector<std::pair<std::string, std::function<Shape()>>> all{
      {"wing_sharp", [] { return make_half_wing(half_wing(0, WingTip::flat, false)); }},
      {"wing_blunt", [] { return make_half_wing(half_wing(0.0025, WingTip::flat, false)); }},
      {"wing_rounded", [] { return make_half_wing(half_wing(0, WingTip::rounded, false)); }},
      {"onera_m6", [] { return make_onera_m6(); }},
      {"wing_closed_sharp", [] { return make_half_wing(half_wing(0, WingTip::flat, true)); }},
      {"wing_closed_blunt", [] { return make_half_wing(half_wing(0.0025, WingTip::flat, true)); }},
  };
  return all;
}

}  // namespace

std::vector<std::string> swept_body_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : bodies()) names.push_back(name);
  return names;
}

CadModel make_swept_body(const std::string& name) {
  Progress silent;
  for (const auto& [known, make] : bodies()) {
    if (known == name) return cad_model_of(make(), {}, silent);
  }
  throw std::invalid_argument("no such body: " + name);
}

CadModel read_swept_cad(const std::string& file) {
  Progress silent;
  return read_cad({&file, 1}, {}, silent);
}

VolumeResult mesh_swept_body(const CadModel& cad, const std::string& name, int levels,
                             const LayerSettings& layers, Progress& progress) {
  VolumeSettings settings;
  settings.fit.levels = levels;
  settings.layers = layers;
  return make_volume(*swept_source(cad, {}, name), cad, settings, progress);
}

}  // namespace flowcage::test
