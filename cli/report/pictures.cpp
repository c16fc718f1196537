#include "cli/report/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "cli/report/camera.hpp"
#include "cli/report/write_png.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

enum class Mode { deviation, quality, patch, block, plain };

const Raster::Settings canvas{};
constexpr double everywhere = std::numeric_limits<double>::max();
constexpr Rgb ink{0.11, 0.15, 0.2}, marker_color{0.82, 0.0, 0.44}, paper{1, 1, 1};
constexpr double dot = 1.5;  // of the letters, pixels

/// A headlight, a little from above, on both sides of a face.
double light_on(const Vec3& normal, const Camera& camera) {
  return std::min(1.0, 0.5 + 0.55 * std::abs(normal.dot((camera.toward + 0.35 * camera.up).normalized())));
}

Rgb scaled(const Rgb& c, double f) {
  return {f * c.r, f * c.g, f * c.b};
}

Rgb face_color(const Scene& scene, Mode mode, std::size_t face, Index point) {
  const SceneSurface& s = scene.mesh;
  switch (mode) {
    case Mode::deviation:
      return verdict_color(deviation_scale(scene.tolerance), s.deviation[point]);
    case Mode::quality:
      return verdict_color(jacobian_scale, s.quality[face]);
    case Mode::patch:
      return s.names[s.name[face]].color;
    case Mode::block:
      return palette_color(static_cast<std::size_t>(s.block[face]));
    case Mode::plain:
      break;
  }
  return neutral_color;
}

/// A polygon of one or more colours, in the light.
void draw_polygon(Raster& raster, const Camera& camera, std::span<const Vec3> corners,
                  std::span<const Rgb> colors, double nearest) {
  Vec3 normal = Vec3::Zero();  // Newell
  for (std::size_t c = 0; c < corners.size(); ++c)
    normal += corners[c].cross(corners[(c + 1) % corners.size()]);
  const double light = light_on(normal.stableNormalized(), camera);
  for (std::size_t c = 2; c < corners.size(); ++c) {
    raster.triangle({camera.project(corners[0]), camera.project(corners[c - 1]), camera.project(corners[c])},
                    {scaled(colors[0], light), scaled(colors[c - 1], light), scaled(colors[c], light)},
                    nearest);
  }
}

/// Lines closer than a few pixels would make all black.
Raster::Pen mesh_pen(double mean_length_in_pixels, double nearest) {
  return {.width = 1,
          .opacity = 0.7 * std::clamp((mean_length_in_pixels - 1.5) / 10, 0.0, 1.0),
          .lift = 2,
          .nearest = nearest};
}

/// Each edge once, since they are painted with less than full opacity.
void draw_lines(Raster& raster, const Camera& camera, std::span<const Vec3> points,
                std::vector<std::array<Index, 2>> edges, double nearest) {
  for (auto& e : edges) {
    if (e[0] > e[1]) std::swap(e[0], e[1]);
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  double length = 0;
  for (const auto& [a, b] : edges) length += (points[a] - points[b]).norm();
  const Raster::Pen pen = mesh_pen(
      camera.pixels_per_metre * length / std::max<double>(1, static_cast<double>(edges.size())), nearest);
  if (pen.opacity < 0.03) return;
  for (const auto& [a, b] : edges) raster.line(camera.project(points[a]), camera.project(points[b]), pen);
}

bool is_outer(const std::string& type) {
  return type == "farfield" || type == "symmetry";
}

void draw_body(Raster& raster, const Camera& camera, const Scene& scene, Mode mode,
               double nearest = everywhere) {
  const SceneSurface& s = scene.mesh;
  std::vector<std::array<Index, 2>> edges;
  for (std::size_t f = 0; f < s.faces.size(); ++f) {
    if (is_outer(s.names[s.name[f]].type)) continue;
    std::array<Vec3, 4> corners;
    std::array<Rgb, 4> colors;
    for (int c = 0; c < 4; ++c) {
      corners[c] = s.points[s.faces[f][c]];
      colors[c] = face_color(scene, mode, f, s.faces[f][c]);
      if (s.faces[f][c] != s.faces[f][(c + 1) % 4]) edges.push_back({s.faces[f][c], s.faces[f][(c + 1) % 4]});
    }
    draw_polygon(raster, camera, corners, colors, nearest);
  }
  draw_lines(raster, camera, s.points, std::move(edges), nearest);
  const Raster::Pen pen{.width = 1.6, .lift = 2.5, .nearest = nearest};
  for (const auto& line : scene.edges) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      raster.line(camera.project(line[i - 1]), camera.project(line[i]), pen);
    }
  }
}

/// Where a plane cuts a cell: a polygon, in order round its middle.
std::vector<Vec3> cut_polygon(const std::array<Vec3, 8>& cell, int axis, double value) {
  std::vector<Vec3> polygon;
  for (const auto& [a, b] : hex_edges) {
    const double from = cell[a][axis] - value, to = cell[b][axis] - value;
    if ((from > 0) != (to > 0)) polygon.push_back(cell[a] + from / (from - to) * (cell[b] - cell[a]));
  }
  if (polygon.empty()) return polygon;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : polygon) middle += p / static_cast<double>(polygon.size());
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::ranges::stable_sort(polygon, {},
                           [&](const Vec3& p) { return std::atan2(p[v] - middle[v], p[u] - middle[u]); });
  return polygon;
}

void draw_cut(Raster& raster, const Camera& camera, const Scene& scene, int axis, double value) {
  const SceneVolume& volume = scene.volume;
  std::vector<Vec3> points;  // of the polygons
  std::vector<std::array<Index, 2>> edges;
  std::size_t first_number = 0, cell = 0;
  for (const auto& [ni, nj, nk] : volume.dims) {
    const auto at = [&, ni = ni, nj = nj](Index i, Index j, Index k) -> const Vec3& {
      return volume.points[volume.numbers[first_number + i + (ni + 1) * (j + std::size_t{1} * (nj + 1) * k)]];
    };
    for (Index k = 0; k < nk; ++k) {
      for (Index j = 0; j < nj; ++j) {
        for (Index i = 0; i < ni; ++i, ++cell) {
          std::array<Vec3, 8> corners;
          for (int c = 0; c < 8; ++c) {
            const auto& [di, dj, dk] = hex_corner_ijk[c];
            corners[c] = at(i + di, j + dj, k + dk);
          }
          const std::vector<Vec3> polygon = cut_polygon(corners, axis, value);
          if (polygon.empty()) continue;
          const std::vector<Rgb> colors(polygon.size(), verdict_color(jacobian_scale, volume.quality[cell]));
          draw_polygon(raster, camera, polygon, colors, everywhere);
          const auto base = static_cast<Index>(points.size()), n = static_cast<Index>(polygon.size());
          points.insert(points.end(), polygon.begin(), polygon.end());
          for (Index c = 0; c < n; ++c) edges.push_back({base + c, base + (c + 1) % n});
        }
      }
    }
    first_number += static_cast<std::size_t>(ni + 1) * (nj + 1) * (nk + 1);
  }
  draw_lines(raster, camera, points, std::move(edges), everywhere);
}

// What is written beside the picture.

/// On a strip of paper: what is behind may be anything.
void draw_title(Raster& raster, std::string_view title, std::string_view second = "") {
  raster.box({0, 0}, {static_cast<double>(canvas.width), second.empty() ? 48.0 : 72.0}, paper);
  raster.text({24, 16}, title, dot + 0.5, ink);
  raster.text({24, 46}, second, dot, ink);
}

void draw_swatch(Raster& raster, const Vec2& at, const Rgb& color, std::string_view text) {
  raster.box(at - Vec2(1, 1), at + Vec2(15, 15), ink);
  raster.box(at, at + Vec2(14, 14), color);
  raster.text(at + Vec2(24, 1.5), text, dot, ink);
}

void draw_scale(Raster& raster, const VerdictScale& scale, std::string_view failure) {
  constexpr int width = 320;
  const double x = 24, y = canvas.height - 84;
  raster.box({x - 10, y - 12}, {x + width + 60, canvas.height - 12}, paper, 0.85);
  raster.box({x - 1, y - 1}, {x + width + 1, y + 17}, ink);
  const auto value_at = [&](double t) {
    return scale.logarithmic ? scale.bad * std::pow(scale.good / scale.bad, t)
                             : scale.bad + t * (scale.good - scale.bad);
  };
  for (int i = 0; i < width; ++i) {
    raster.box({x + i, y}, {x + i + 1, y + 16}, verdict_color(scale, value_at((i + 0.5) / width)));
  }
  for (int tick = 0; tick <= 4; ++tick) {
    raster.text({x + width * tick / 4.0 - (tick > 0 ? 14 : 0), y + 23},
                fmt::format("{:.2g}", value_at(tick / 4.0)), dot, ink);
  }
  draw_swatch(raster, {x, y + 46}, failure_color, failure);
}

void draw_names(Raster& raster, const Scene& scene) {
  constexpr std::size_t most = 20;
  double y = 64;
  std::size_t shown = 0, left = 0;
  for (const SceneName& name : scene.mesh.names) {
    if (is_outer(name.type)) continue;
    if (shown++ >= most) {
      ++left;
      continue;
    }
    draw_swatch(raster, {24, y}, name.color, name.name.empty() ? "(no name)" : name.name.substr(0, 60));
    y += 24;
  }
  if (left > 0) raster.text({24, y}, fmt::format("and {} more", left), dot, ink);
}

void draw_legend(Raster& raster, const Scene& scene, Mode mode) {
  if (mode == Mode::deviation) {
    draw_title(raster, "deviation from the CAD, in its diagonals");
    draw_scale(raster, deviation_scale(scene.tolerance),
               fmt::format("above the tolerance, {:g}", scene.tolerance));
  }
  if (mode == Mode::quality) {
    draw_title(raster, "scaled Jacobian of the cells at the wall");
    draw_scale(raster, jacobian_scale, "inverted or collapsed");
  }
  if (mode == Mode::patch) {
    draw_title(raster, "patches");
    draw_names(raster, scene);
  }
  if (mode == Mode::block) {
    draw_title(raster, fmt::format("{} blocks, each a colour", scene.volume.dims.size()));
  }
}

std::vector<Vec3> body_points(const Scene& scene) {
  std::vector<Vec3> points;
  for (std::size_t f = 0; f < scene.mesh.faces.size(); ++f) {
    if (is_outer(scene.mesh.names[scene.mesh.name[f]].type)) continue;
    for (const Index p : scene.mesh.faces[f]) points.push_back(scene.mesh.points[p]);
  }
  return points;
}

Camera standing_at(const Vec3& toward, const Vec3& target) {
  Camera camera = camera_from(toward, target);
  camera.centre = {canvas.width / 2.0, canvas.height / 2.0};
  return camera;
}

Image body_picture(const Scene& scene, Mode mode) {
  Raster raster(canvas);
  Camera camera = standing_at({-1, -1.4, 0.8}, scene.body.center());
  // Between title and scale.
  fit_points(camera, body_points(scene), 0.8 * canvas.width, 0.76 * canvas.height);
  camera.centre.y() -= 14;
  draw_body(raster, camera, scene, mode);
  draw_legend(raster, scene, mode);
  return raster.image();
}

Image cut_picture(const Scene& scene, int axis) {
  Raster raster(canvas);
  Vec3 toward = Vec3::Unit(axis);
  if (axis == 1) toward = -toward;  // x runs to the right
  Camera camera = standing_at(toward, scene.body.center());
  // Beside the middle, where lines of a symmetric mesh would lie in the plane.
  const double value = scene.body.center()[axis] + 0.005 * scene.body.sizes()[axis];
  fit_points(camera, body_points(scene), 0.55 * canvas.width, 0.55 * canvas.height);
  Vec3 in_plane = camera.target;
  in_plane[axis] = value;
  draw_body(raster, camera, scene, Mode::plain, camera.project(in_plane).z());
  draw_cut(raster, camera, scene, axis, value);
  draw_title(raster, fmt::format("cut at {} = {:.5g} m: scaled Jacobian of the cells", "xyz"[axis], value),
             scene.volume.stride == 1
                 ? ""
                 : fmt::format("of a large mesh: a cell stands for up to {0} x {0} x {0}, with the "
                               "least among them",
                               scene.volume.stride));
  draw_scale(raster, jacobian_scale, "inverted or collapsed");
  return raster.image();
}

/// The normal of the face of the body that is nearest to a place.
Vec3 normal_near(const Scene& scene, const Vec3& place) {
  const SceneSurface& s = scene.mesh;
  double least = std::numeric_limits<double>::max();
  Vec3 normal = Vec3::UnitZ();
  for (std::size_t f = 0; f < s.faces.size(); ++f) {
    if (is_outer(s.names[s.name[f]].type)) continue;
    const auto at = [&](int c) { return s.points[s.faces[f][c]]; };
    const double distance = (at(0) - place).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    normal = (at(2) - at(0)).cross(at(3) == at(2) ? Vec3(at(2) - at(1)) : Vec3(at(3) - at(1)));
  }
  return normal.stableNormalized();
}

Image failure_picture(const Scene& scene, const Gate& gate) {
  Raster raster(canvas);
  const bool of_cells = !scene.worst.empty() && gate.name.ends_with("cells");
  const Mode mode = of_cells ? Mode::quality : Mode::deviation;
  Camera camera = standing_at(normal_near(scene, *gate.place) + Vec3(-0.25, -0.35, 0.2), *gate.place);
  camera.pixels_per_metre = canvas.width / (0.12 * scene.diagonal);
  draw_body(raster, camera, scene, mode);
  if (of_cells) {
    for (const SceneCell& cell : scene.worst) {
      if (cell.metric != "scaled_jacobian") continue;
      for (const auto& [a, b] : hex_edges) {
        raster.line(camera.project(cell.corners[a]), camera.project(cell.corners[b]),
                    {.width = 2.5, .color = failure_color, .lift = everywhere});
      }
    }
  }
  raster.ring(camera.centre, 26, 7, paper);
  raster.ring(camera.centre, 26, 4, marker_color);
  draw_legend(raster, scene, mode);
  draw_title(raster,
             fmt::format("{} is missed: {:.3g}, the limit is {:.3g}", gate.name, gate.value, gate.limit),
             gate.detail);
  return raster.image();
}

/// The pictures, in the order of picture_names().
std::vector<std::pair<std::string, std::function<Image()>>> pictures_of(const Scene& scene,
                                                                        const std::vector<Gate>& gates) {
  std::vector<std::pair<std::string, std::function<Image()>>> pictures;
  const auto body = [&](const char* name, Mode mode) {
    pictures.emplace_back(name, [&scene, mode] { return body_picture(scene, mode); });
  };
  if (!scene.mesh.deviation.empty()) body("deviation.png", Mode::deviation);
  if (!scene.mesh.quality.empty()) body("quality.png", Mode::quality);
  body("patch.png", Mode::patch);
  if (!scene.mesh.block.empty()) body("block.png", Mode::block);
  for (int axis = 0; axis < 3 && !scene.volume.dims.empty(); ++axis) {
    pictures.emplace_back(fmt::format("cut_{}.png", "xyz"[axis]),
                          [&scene, axis] { return cut_picture(scene, axis); });
  }
  for (const Gate& gate : gates) {
    if (gate.holds || !gate.place) continue;
    pictures.emplace_back("missed_" + gate.name + ".png", [&] { return failure_picture(scene, gate); });
  }
  return pictures;
}

}  // namespace

std::vector<std::string> picture_names() {
  return {"deviation.png",
          "quality.png",
          "patch.png",
          "block.png",
          "cut_x.png",
          "cut_y.png",
          "cut_z.png",
          "missed_max_deviation.png",
          "missed_coverage_deviation.png",
          "missed_surface_folds.png",
          "missed_inverted_cells.png",
          "missed_unproved_cells.png"};
}

void write_pictures(AtomicFolder& folder, const Scene& scene, const std::vector<Gate>& gates) {
  for (const auto& [name, draw] : pictures_of(scene, gates)) {
    const std::unique_ptr<OutputFile> file = folder.create(name);
    write_png(*file, draw());
    file->close();
  }
}

}  // namespace flowcage
