#include "tests/volume/volume_bodies.hpp"

#include "occ_bridge/shapes.hpp"
#include "tests/refit/fit_bodies.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

namespace flowcage::test {
namespace {

/// An L of two legs, 2 x 2 x 1 with arms 1 wide: one concave edge, 16 vertices, every edge a crease.
Cage l_shape_cage() {
  Cage cage = empty_cage();
  const std::vector<std::array<double, 2>> section{{0, 0}, {1, 0}, {2, 0}, {2, 1},
                                                   {1, 1}, {1, 2}, {0, 2}, {0, 1}};
  const auto n = static_cast<Index>(section.size());
  for (const double z : {0.0, 1.0}) {
    for (const auto& [x, y] : section) cage.points.emplace_back(x, y, z);
  }
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    add_face(cage, {i, j, n + j, n + i});
  }
  const std::array<std::array<Index, 4>, 3> cells{{{0, 1, 4, 7}, {1, 2, 3, 4}, {7, 4, 5, 6}}};
  for (const auto& c : cells) {
    add_face(cage, {c[3], c[2], c[1], c[0]});
    add_face(cage, {n + c[0], n + c[1], n + c[2], n + c[3]});
  }
  for (Index i = 0; i < n; ++i) {
    for (const Index end : {Index{0}, n}) add_crease(cage, end + i, end + (i + 1) % n);
    const bool straight = i == 1 || i == 7;
    if (!straight) add_crease(cage, i, n + i);
  }
  return cage;
}

CadModel l_shape() {
  Progress silent;
  const Shape whole = translated(make_box(Vec3(2, 2, 1)), Vec3(1, 1, 0.5));
  const Shape cut = translated(make_box(Vec3(1, 1, 1)), Vec3(1.5, 1.5, 0.5));
  return cad_model_of(make_difference(whole, cut), {}, silent);
}

VolumeBody plain(const std::string& name) {
  FitBody body = make_fit_body(name);
  return {name, std::move(body.cad), std::move(body.cage), {}};
}

}  // namespace

std::vector<std::string> volume_body_names() {
  return {"sphere",  "torus",      "cylinder",   "rounded_box",
          "l_shape", "wing_sharp", "wing_blunt", "wing_fuselage"};
}

VolumeBody make_volume_body(const std::string& name) {
  VolumeBody body = name == "l_shape" ? VolumeBody{name, l_shape(), l_shape_cage(), {}} : plain(name);
  if (name == "torus") body.outer = torus_cage(1.8, 1.6, 4, 4);
  body.length = body.cad.bounds().sizes().maxCoeff();
  return body;
}

}  // namespace flowcage::test
