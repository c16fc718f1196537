#include "cli/report/raster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flowcage {
namespace {

std::uint8_t byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

}  // namespace

Raster::Raster(const Settings& settings)
    : width_(settings.width * settings.samples),
      height_(settings.height * settings.samples),
      samples_(settings.samples),
      depth_(static_cast<std::size_t>(width_) * height_, -std::numeric_limits<float>::max()),
      color_(depth_.size()) {
  for (int y = 0; y < height_; ++y) {
    const double f = (y + 0.5) / height_;
    const auto mix = [&](double a, double b) { return byte(a + f * (b - a)); };
    const Rgb &a = settings.top, &b = settings.bottom;
    std::fill_n(color_.begin() + std::ptrdiff_t{y} * width_, width_,
                std::array{mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)});
  }
}

void Raster::paint(std::size_t sample, const Rgb& color, double opacity) {
  auto& there = color_[sample];
  const std::array<double, 3> wanted{color.r, color.g, color.b};
  for (int c = 0; c < 3; ++c) there[c] = byte(opacity * wanted[c] + (1 - opacity) * there[c] / 255.0);
}

void Raster::triangle(const std::array<Vec3, 3>& corners, const std::array<Rgb, 3>& colors, double nearest) {
  std::array<Vec2, 3> p;
  Eigen::AlignedBox2d bounds;
  for (int c = 0; c < 3; ++c) {
    p[c] = samples_ * corners[c].head<2>();
    if (!p[c].allFinite()) return;
    bounds.extend(p[c]);
  }
  const auto cross = [](const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); };
  const double area = cross(p[1] - p[0], p[2] - p[0]);
  if (area == 0) return;
  const auto first = [](double x) { return static_cast<int>(std::max(0.0, std::ceil(x - 0.5))); };
  const auto last = [](double x, int n) { return static_cast<int>(std::floor(std::min(x - 0.5, n - 1.0))); };
  for (int y = first(bounds.min().y()); y <= last(bounds.max().y(), height_); ++y) {
    for (int x = first(bounds.min().x()); x <= last(bounds.max().x(), width_); ++x) {
      const Vec2 q(x + 0.5, y + 0.5);
      const double a = cross(p[2] - p[1], q - p[1]) / area, b = cross(p[0] - p[2], q - p[2]) / area;
      const double c = 1 - a - b;
      if (a < 0 || b < 0 || c < 0) continue;
      const double z = a * corners[0].z() + b * corners[1].z() + c * corners[2].z();
      const std::size_t sample = static_cast<std::size_t>(y) * width_ + x;
      if (z > nearest || z < depth_[sample]) continue;
      depth_[sample] = static_cast<float>(z);
      const auto mix = [&](double r, double s, double t) { return byte(a * r + b * s + c * t); };
      color_[sample] = {mix(colors[0].r, colors[1].r, colors[2].r),
                        mix(colors[0].g, colors[1].g, colors[2].g),
                        mix(colors[0].b, colors[1].b, colors[2].b)};
    }
  }
}

template <typename Inside>
void Raster::fill(const Eigen::AlignedBox2d& bounds, const Rgb& color, double opacity, const Inside& inside) {
  const auto clamped = [](double x, int n) { return static_cast<int>(std::clamp(x, 0.0, double(n))); };
  for (int y = clamped(bounds.min().y(), height_); y < clamped(bounds.max().y() + 1, height_); ++y) {
    for (int x = clamped(bounds.min().x(), width_); x < clamped(bounds.max().x() + 1, width_); ++x) {
      const std::size_t sample = static_cast<std::size_t>(y) * width_ + x;
      if (inside(Vec2(x + 0.5, y + 0.5), sample)) paint(sample, color, opacity);
    }
  }
}

void Raster::line(const Vec3& a, const Vec3& b, const Pen& pen) {
  const Vec2 p = samples_ * a.head<2>(), q = samples_ * b.head<2>();
  const double half = 0.5 * pen.width * samples_, length = (q - p).norm();
  if (!(length > 0) || !p.allFinite() || !q.allFinite()) return;
  const Vec2 along = (q - p) / length;
  // Long lines in short pieces: the box round a slanted one is nearly empty.
  const int pieces = static_cast<int>(std::min(1000.0, std::ceil(length / (8 * half + 8))));
  for (int piece = 0; piece < pieces; ++piece) {
    const double from = length * piece / pieces, to = length * (piece + 1) / pieces;
    Eigen::AlignedBox2d bounds(Vec2(p + from * along));
    bounds.extend(Vec2(p + to * along));
    bounds.min().array() -= half;
    bounds.max().array() += half;
    fill(bounds, pen.color, pen.opacity, [&](const Vec2& at, std::size_t sample) {
      const Vec2 d = at - p;
      const double s = d.dot(along);
      if (s < from || s >= to || std::abs(d.x() * along.y() - d.y() * along.x()) > half) return false;
      const double z = a.z() + s / length * (b.z() - a.z());
      return z <= pen.nearest && z + pen.lift >= depth_[sample];
    });
  }
}

void Raster::box(const Vec2& low, const Vec2& high, const Rgb& color, double opacity) {
  const Eigen::AlignedBox2d bounds(Vec2(samples_ * low), Vec2(samples_ * high));
  fill(bounds, color, opacity, [&](const Vec2& at, std::size_t) { return bounds.contains(at); });
}

void Raster::text(const Vec2& at, std::string_view text, double dot, const Rgb& color) {
  double column = 0;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if ((code & 0xC0U) == 0x80U) continue;  // the rest of a letter in UTF-8
    const auto& columns = bitmap_font[code >= ' ' && code <= '~' ? code - ' ' : '?' - ' '];
    for (int x = 0; x < 5; ++x) {
      for (int y = 0; y < 7; ++y) {
        if ((columns[x] >> y & 1) == 0) continue;
        const Vec2 low = at + dot * Vec2(column + x, y);
        box(low, low + Vec2(dot, dot), color);
      }
    }
    column += 6;
  }
}

void Raster::ring(const Vec2& centre, double radius, double width, const Rgb& color) {
  const Vec2 middle = samples_ * centre;
  const double inner = samples_ * (radius - width / 2), outer = samples_ * (radius + width / 2);
  fill({middle - Vec2(outer, outer), middle + Vec2(outer, outer)}, color, 1,
       [&](const Vec2& at, std::size_t) {
         const double r = (at - middle).norm();
         return r >= inner && r <= outer;
       });
}

Image Raster::image() const {
  Image image{width_ / samples_, height_ / samples_, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) * image.height);
  const int count = samples_ * samples_;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::array<int, 3> sum{};
      for (int s = 0; s < count; ++s) {
        const auto& sample = color_[static_cast<std::size_t>(y * samples_ + s / samples_) * width_ +
                                    x * samples_ + s % samples_];
        for (int c = 0; c < 3; ++c) sum[c] += sample[c];
      }
      const auto mean = [&](int c) { return static_cast<std::uint8_t>((sum[c] + count / 2) / count); };
      image.pixels.push_back({mean(0), mean(1), mean(2)});
    }
  }
  return image;
}

}  // namespace flowcage
