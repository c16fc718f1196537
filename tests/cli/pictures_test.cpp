// --pictures: the rasteriser, and the files that the program leaves.
#include <cmath>

#include "cli/report/camera.hpp"
#include "cli/report/raster.hpp"
#include "tests/catch.hpp"
#include "tests/cli/png_image.hpp"
#include "tests/cli/sphere_folder.hpp"

using namespace flowcage;
using Strings = std::vector<std::string>;
using tests::PngImage;
using tests::read_png;
using tests::SphereFolder;

namespace {

constexpr Rgb black{0, 0, 0}, white{1, 1, 1}, red{1, 0, 0}, blue{0, 0, 1};
using Pixel = std::array<std::uint8_t, 3>;
constexpr double everywhere = 1e300;

Raster blank(int width, int height, int samples = 4) {
  return Raster({.width = width, .height = height, .samples = samples, .top = white, .bottom = white});
}
Pixel at(const Image& image, int x, int y) {
  return image.pixels[static_cast<std::size_t>(y * image.width + x)];
}
int painted(const Image& image) {
  return static_cast<int>(std::ranges::count_if(image.pixels, [](const Pixel& p) {
    return p != Pixel{255, 255, 255};
  }));
}

/// Pixels right of `from` that differ from the background, which the last column shows.
int foreground(const PngImage& image, int from) {
  int count = 0;
  for (int y = 80; y < image.height; ++y) {
    const auto* row = &image.pixels[static_cast<std::size_t>(y) * image.width];
    for (int x = from; x < image.width; ++x) count += row[x] != row[image.width - 1] ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("raster: triangles cover pixels by their area, the nearer hides the farther") {
  Raster raster = blank(8, 8);
  const auto half = [&](double z, const Rgb& color) {  // below the diagonal of [2, 6]^2
    raster.triangle({Vec3(2, 2, z), Vec3(2, 6, z), Vec3(6, 6, z)}, {color, color, color}, everywhere);
  };
  half(1, red);
  Image image = raster.image();
  CHECK(at(image, 2, 4) == Pixel{255, 0, 0});
  CHECK(at(image, 4, 2) == Pixel{255, 255, 255});
  CHECK(at(image, 1, 4) == Pixel{255, 255, 255});
  // On the diagonal 10 of 16 samples, those on it included.
  CHECK(at(image, 3, 3)[1] == Approx(255 * 6 / 16.0).margin(1));
  half(0, blue);  // behind
  CHECK(raster.image().pixels == image.pixels);
  half(2, blue);
  CHECK(at(raster.image(), 2, 4) == Pixel{0, 0, 255});
  raster.triangle({Vec3(2, 2, 9), Vec3(2, 6, 9), Vec3(6, 6, 9)}, {red, red, red}, 8);  // before the nearest
  CHECK(at(raster.image(), 2, 4) == Pixel{0, 0, 255});
  // Colours are linear between corners; what is outside or no number paints nothing.
  Raster mixed = blank(100, 4);
  for (const auto& [a, b, c] : {std::tuple{Vec3(0, 0, 0), Vec3(100, 0, 0), Vec3(0, 4, 0)},
                                {Vec3(100, 0, 0), Vec3(100, 4, 0), Vec3(0, 4, 0)}}) {
    const auto color = [](const Vec3& p) { return p.x() > 0 ? white : black; };
    mixed.triangle({a, b, c}, {color(a), color(b), color(c)}, everywhere);
  }
  CHECK(at(mixed.image(), 25, 2)[0] == Approx(255 * 0.255).margin(1.5));
  const Image before = mixed.image();
  mixed.triangle({Vec3(0, 0, 5), Vec3(std::nan(""), 0, 5), Vec3(0, 4, 5)}, {red, red, red}, everywhere);
  mixed.triangle({Vec3(-9, 0, 5), Vec3(-5, 0, 5), Vec3(-5, 4, 5)}, {red, red, red}, everywhere);
  CHECK(mixed.image().pixels == before.pixels);
}

TEST_CASE("raster: lines, hidden where a surface is nearer; boxes, rings and letters") {
  Raster raster = blank(40, 20);
  raster.triangle({Vec3(20, -50, 5), Vec3(20, 70, 5), Vec3(80, 10, 5)}, {blue, blue, blue}, everywhere);
  raster.line({5, 10, 4}, {35, 10, 4}, {.width = 2, .color = black});
  Image image = raster.image();
  CHECK(at(image, 10, 9) == Pixel{0, 0, 0});
  CHECK(at(image, 10, 10) == Pixel{0, 0, 0});
  CHECK(at(image, 10, 11) == Pixel{255, 255, 255});
  CHECK(at(image, 30, 10) == Pixel{0, 0, 255});  // behind the surface
  raster.line({5, 10, 4}, {35, 10, 4}, {.width = 2, .opacity = 0.5, .color = white, .lift = 1.5});
  image = raster.image();
  CHECK(at(image, 30, 10) == Pixel{128, 128, 255});
  CHECK(at(image, 10, 10) == Pixel{128, 128, 128});  // each sample once, whatever pieces a line is painted in

  Raster letters = blank(30, 20);
  letters.text({1, 1}, "L", 2, black);
  CHECK(painted(letters.image()) == (7 + 4) * 4);
  letters.text({13, 1}, "\xC3\xA9", 2, black);  // one letter beyond ASCII is one '?'
  Raster question = blank(30, 20);
  question.text({1, 1}, "L?", 2, black);
  CHECK(letters.image().pixels == question.image().pixels);

  Raster ring = blank(100, 100);
  ring.ring({50, 50}, 40, 2, black);
  double sum = 0;
  for (const Pixel& p : ring.image().pixels) sum += 1 - p[0] / 255.0;
  CHECK(sum == Approx(2 * 3.14159265 * 40 * 2).epsilon(0.01));
}

TEST_CASE("camera: right, up and toward are a right-handed frame; a box of points fills the picture") {
  for (const Vec3& toward : {Vec3(-1, -1.4, 0.8), Vec3(0, 0, 1), Vec3(0, -1, 0)}) {
    Camera camera = camera_from(toward, Vec3(7, 8, 9));
    CHECK((camera.right.cross(camera.up) - camera.toward).norm() < 1e-12);
    camera.centre = {50, 40};
    CHECK(camera.project(camera.target).head<2>() == camera.centre);
    CHECK(camera.project(camera.target + camera.right).x() == Approx(51));
    CHECK(camera.project(camera.target + camera.up).y() == Approx(39));
    CHECK(camera.project(camera.target + camera.toward).z() == Approx(1));
    const std::vector<Vec3> points{camera.target - 3 * camera.right,
                                   camera.target + 5 * camera.right + camera.up};
    fit_points(camera, points, 80, 60);
    CHECK(camera.project(points[0]).x() == Approx(10));
    CHECK(camera.project(points[1]).x() == Approx(90));
  }
}

TEST_CASE("mesh --pictures: what stands in the files is the sphere, and older pictures give way") {
  const SphereFolder folder;
  std::filesystem::create_directory(folder.path() / "pictures");
  folder.put("pictures/missed_surface_folds.png", "of an earlier run");
  folder.put("pictures/notes.txt", "the user's");
  const ProgramRun run =
      folder.run("mesh", {"--levels", "2", "--tolerance", "1e-3", "-o", "m.vtu", "--pictures", "pictures"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Strings names{"block.png",     "cut_x.png", "cut_y.png",  "cut_z.png",
                      "deviation.png", "patch.png", "quality.png"};
  for (const std::string& name : names) {
    INFO(name);
    const PngImage image = read_png(folder.path() / "pictures" / name);
    CHECK(image.width == 1200);
    CHECK(image.height == 800);
    CHECK(image.colors() > 100);
  }
  CHECK(folder.text_of("pictures/notes.txt") == "the user's");
  CHECK_FALSE(std::filesystem::exists(folder.path() / "pictures/missed_surface_folds.png"));
  // A disc 0.76 x 800 pixels high, less what 96 flat faces leave out; right of the names of patches.
  CHECK(foreground(read_png(folder.path() / "pictures/patch.png"), 250) ==
        Approx(M_PI * 304 * 304).epsilon(0.02));
  // The cut fills the picture and leaves the sphere's inside to the wall behind, which is grey.
  const PngImage cut = read_png(folder.path() / "pictures/cut_x.png");
  int grey = 0;
  for (const auto& [r, g, b] : cut.pixels) grey += b > r && b - r < 30 && g > r && b < 225 && b > 90 ? 1 : 0;
  CHECK(grey > 0.5 * M_PI * 220 * 220);
  CHECK(grey < 1.1 * M_PI * 220 * 220);
}

TEST_CASE("--pictures of a missed gate show the place; of a surface, what it has") {
  const SphereFolder folder;
  const ProgramRun run = folder.run(
      "surface", {"--levels", "1", "--tolerance", "1e-9", "-o", "s.obj", "--pictures", "pictures"});
  CHECK(run.exit_code == 4);
  Strings names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "pictures")) {
    names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  CHECK(names ==
        Strings{"deviation.png", "missed_coverage_deviation.png", "missed_max_deviation.png", "patch.png"});
  const PngImage missed = read_png(folder.path() / "pictures/missed_max_deviation.png");
  CHECK(missed.pixels[static_cast<std::size_t>(400) * 1200 + 600 + 26] == Pixel{209, 0, 112});  // the ring
  // All deviations are beyond such a tolerance.
  CHECK(std::ranges::count(missed.pixels, Pixel{217, 0, 217}) > 1000);
  // A place that cannot be written is refused before the work; a folder that is another output, too.
  CHECK(folder.run("surface", {"-o", "s.obj", "--pictures", "none/pictures"}).exit_code == 5);
  CHECK(folder.run("surface", {"-o", "s.obj", "--pictures", "s.obj"}).exit_code == 2);
}
