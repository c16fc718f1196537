#include "tests/fuzz/mutate_cad.hpp"

#include <algorithm>
#include <array>
#include <random>

namespace flowcage {
namespace {

class Mutator {
 public:
  Mutator(std::string text, std::uint32_t seed) : text_(std::move(text)), random_(seed) {}

  std::string run(std::uint32_t kind) {
    const std::size_t times = 1 + below(8);
    for (std::size_t n = 0; n < times && text_.size() > 200; ++n) {
      switch (kind) {
        case 0:
          text_[below(text_.size())] ^= static_cast<char>(1U << below(8));
          break;
        case 1:
          cut_line();
          break;
        case 2:
          replace_number();
          break;
        case 3:
          move_piece();
          break;
        default:
          truncate();
          return text_;
      }
    }
    return text_;
  }

 private:
  /// std::uniform_int_distribution differs between libraries; a seed must mean the same file everywhere.
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  void cut_line() {
    const std::size_t middle = below(text_.size());
    const std::size_t before = text_.rfind('\n', middle);
    const std::size_t first = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = text_.find('\n', middle);
    text_.erase(first, (end == std::string::npos ? text_.size() : end + 1) - first);
  }

  /// In IGES columns count: the new number has the old one's length.
  void replace_number() {
    static constexpr std::array<const char*, 6> values{"NaN", "1.E308", "-1.E308", "0.", "-1", "999999999"};
    const std::size_t first = text_.find_first_of("0123456789", below(text_.size()));
    if (first == std::string::npos) return;
    const std::size_t last = std::min(text_.find_first_not_of("0123456789.E+-", first), text_.size());
    std::string value = values[below(values.size())];
    const bool fixed = text_.compare(0, 3, "ISO") != 0;
    if (fixed) value.resize(last - first, ' ');
    text_.replace(first, last - first, value);
  }

  void move_piece() {
    const std::size_t to = below(text_.size()), from = below(text_.size()), length = below(200);
    const std::string piece = text_.substr(from, length);
    text_.replace(to, std::min(length, text_.size() - to), piece);
  }

  void truncate() {
    const std::string tail = text_.substr(text_.size() - 100);
    text_ = text_.substr(0, below(text_.size()));
    if (below(4) != 0) text_ += "\n" + tail;
  }

  std::string text_;
  std::mt19937 random_;
};

}  // namespace

std::string mutated_cad(std::string text, std::uint32_t seed) {
  return Mutator(std::move(text), seed).run(seed % 5);
}

}  // namespace flowcage
