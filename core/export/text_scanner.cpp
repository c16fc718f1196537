#include "core/export/text_scanner.hpp"

#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "core/base/error.hpp"
#include "core/export/file_text.hpp"

namespace flowcage {
namespace {

constexpr std::string_view white = " \t\r\n\f\v";
constexpr const char* remake = "the file is damaged or cut off: write it again with the program that made it";

template <typename Number>
Number parsed(TextScanner& scanner, const char* what) {
  std::string_view text = scanner.word();
  if (text.empty()) scanner.fail(fmt::format("the file ends where {} is expected", what), remake);
  const std::string_view shown = text.substr(0, 40);
  if (text.front() == '+') text.remove_prefix(1);
  Number value{};
  const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || stop != text.data() + text.size()) {
    scanner.fail(fmt::format("{} is expected, not \"{}\"", what, excerpt(shown, 0)), remake);
  }
  return value;
}

}  // namespace

TextScanner::TextScanner(const std::filesystem::path& file)
    : file_(file.string()), text_(read_whole_file(file)) {}

std::string_view TextScanner::word() {
  last_ = std::min(text_.find_first_not_of(white, next_), text_.size());
  next_ = std::min(text_.find_first_of(white, last_), text_.size());
  return std::string_view(text_).substr(last_, next_ - last_);
}

std::string_view TextScanner::line() {
  last_ = next_;
  const std::size_t end = std::min(text_.find('\n', next_), text_.size());
  std::string_view result = std::string_view(text_).substr(last_, end - last_);
  if (result.ends_with('\r')) result.remove_suffix(1);
  next_ = std::min(end + 1, text_.size());
  return result;
}

bool TextScanner::at_end() {
  return text_.find_first_not_of(white, next_) == std::string::npos;
}

Offset TextScanner::integer(const char* what) {
  return parsed<Offset>(*this, what);
}

double TextScanner::real(const char* what) {
  return parsed<double>(*this, what);
}

Vec3 TextScanner::point() {
  Vec3 p;
  for (int d = 0; d < 3; ++d) p[d] = real("a coordinate");
  if (!p.allFinite()) fail("a coordinate is not finite", remake);
  return p;
}

Offset TextScanner::count(const char* what, std::size_t bytes) {
  const Offset value = integer(what);
  if (value < 0) fail(fmt::format("{} is {}", what, value), remake);
  if (value > std::numeric_limits<Index>::max()) {
    fail(fmt::format("{} is {}, more than flowcage handles", what, value),
         "give a mesh of less than 2147483647 points and cells");
  }
  if (static_cast<std::size_t>(value) > (text_.size() - next_) / bytes + 1) {
    fail(fmt::format("{} is {}, but only {} bytes follow", what, value, text_.size() - next_), remake);
  }
  return value;
}

void TextScanner::fail(const std::string& what, const std::string& remedy) const {
  throw input_error(file_, line_of(text_, last_), what, remedy);
}

}  // namespace flowcage
