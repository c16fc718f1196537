#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "cli/report/color_map.hpp"
#include "core/base/types.hpp"

namespace flowcage {

/// A picture, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;  ///< sRGB
};

/// Paints triangles and lines in the order of their depth, without a display. Places are in pixels of the
/// picture: x to the right, y down, z toward the viewer. Each pixel is the mean of samples x samples of them.
/// What is painted later over the same place at the same depth wins. Knows nothing of meshes and cameras.
class Raster {
 public:
  struct Settings {
    int width = 1200, height = 800;
    int samples = 3;
    Rgb top{0.90, 0.93, 0.96}, bottom{0.99, 0.99, 1.0};  ///< of the background, a gradient
  };
  explicit Raster(const Settings& settings);

  /// Colours at the corners, linear between them. Parts with z > `nearest` are left out.
  void triangle(const std::array<Vec3, 3>& corners, const std::array<Rgb, 3>& colors, double nearest);

  struct Pen {
    double width = 1, opacity = 1;
    Rgb color{0.05, 0.08, 0.1};
    double lift = 0;  ///< toward the viewer: lines on a surface are seen
    double nearest = 1e300;
  };
  void line(const Vec3& a, const Vec3& b, const Pen& pen);

  /// Over all that was painted: a filled box, and text in a fixed font of 6 x 8 dots (`dot` pixels each) an
  /// ASCII letter from its upper left corner; other bytes of UTF-8 become one '?' a letter.
  void box(const Vec2& low, const Vec2& high, const Rgb& color, double opacity = 1);
  void text(const Vec2& at, std::string_view text, double dot, const Rgb& color);
  void ring(const Vec2& centre, double radius, double width, const Rgb& color);

  Image image() const;

 private:
  void paint(std::size_t sample, const Rgb& color, double opacity);
  template <typename Inside>
  void fill(const Eigen::AlignedBox2d& bounds, const Rgb& color, double opacity, const Inside& inside);

  int width_, height_, samples_;  ///< in samples; samples a pixel and direction
  std::vector<float> depth_;
  std::vector<std::array<std::uint8_t, 3>> color_;
};

/// Columns of the letters ' ' to '~' from the left, the least bit at the top: seven dots high, five wide.
extern const std::array<std::array<std::uint8_t, 5>, 95> bitmap_font;

}  // namespace flowcage
