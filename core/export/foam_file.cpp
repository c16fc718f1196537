#include "core/export/foam_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/export/file_text.hpp"

namespace flowcage {
namespace {

constexpr const char* remake = "write the mesh again with the program that made it";

bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

bool ends_word(char c) {
  return is_space(c) || c == '(' || c == ')' || c == '{' || c == '}' || c == ';' || c == '"';
}

}  // namespace

FoamFile::FoamFile(const std::filesystem::path& file) : name_(file.string()) {
  const std::filesystem::path packed = file.string() + ".gz";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored) && std::filesystem::exists(packed, ignored)) {
    throw input_error(packed.string(), 0, "is compressed", "unpack it: gunzip " + packed.string());
  }
  text_ = read_whole_file(file);
  skip_space();
  if (read_word() != "FoamFile") fail(0, "does not begin with a FoamFile header", remake);
  expect('{');
  while (!accept('}')) {
    const std::string key = read_word();
    if (key.empty()) fail("a keyword of the header is missing");
    skip_value(&header_[key]);
  }
  const std::string format = header("format"), arch = header("arch");
  if (format != "ascii" && format != "binary") {
    fail(0, fmt::format("the header's format is \"{}\", neither ascii nor binary", format), remake);
  }
  binary_ = format == "binary";
  if (arch.find("MSB") != std::string::npos) {
    fail(0, "is big-endian", "convert it to ASCII where it was written: foamFormatConvert");
  }
  if (arch.find("label=64") != std::string::npos) label_bytes_ = 8;
  if (arch.find("scalar=32") != std::string::npos) scalar_bytes_ = 4;
}

std::string FoamFile::header(const std::string& key) const {
  const auto it = header_.find(key);
  return it == header_.end() ? std::string() : it->second;
}

void FoamFile::fail(std::size_t position, const std::string& what, const std::string& remedy) const {
  if (binary_ && position > 1000) {
    throw input_error(name_, 0, fmt::format("{} (at byte {})", what, position), remedy);
  }
  throw input_error(name_, line_of(text_, position), what, remedy);
}

void FoamFile::fail(const std::string& what) const {
  if (at_ >= text_.size()) fail(at_, what + ": the file ends here", remake);
  fail(at_, fmt::format("{}, found \"{}\"", what, excerpt(text_, at_)), remake);
}

void FoamFile::skip_space() {
  while (at_ < text_.size()) {
    if (is_space(text_[at_])) {
      ++at_;
    } else if (text_.compare(at_, 2, "//") == 0) {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (text_.compare(at_, 2, "/*") == 0) {
      const auto end = text_.find("*/", at_ + 2);
      if (end == std::string::npos) fail("a comment has no end");
      at_ = end + 2;
    } else {
      return;
    }
  }
}

bool FoamFile::accept(char c) {
  skip_space();
  if (at_ >= text_.size() || text_[at_] != c) return false;
  ++at_;
  return true;
}

void FoamFile::expect(char c) {
  if (!accept(c)) fail(fmt::format("'{}' expected", c));
}

std::string FoamFile::read_word() {
  skip_space();
  std::string word;
  if (at_ < text_.size() && text_[at_] == '"') {
    const auto end = text_.find('"', at_ + 1);
    if (end == std::string::npos) fail("a quoted text has no end");
    word = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return word;
  }
  while (at_ < text_.size() && !ends_word(text_[at_])) word += text_[at_++];
  return word;
}

// Reads over "value;" or "{ dictionary }" behind a keyword; plain gets a value of one word or quoted text.
void FoamFile::skip_value(std::string* plain) {
  const std::size_t start = at_;
  std::string word;
  int words = 0, depth = 0;
  while (true) {
    skip_space();
    if (at_ >= text_.size()) {
      at_ = start;
      fail("a value has no end");
    }
    const char c = text_[at_];
    if (c == ';' && depth == 0) {
      ++at_;
      break;
    }
    if (c == '(' || c == '{') {
      ++depth;
      ++at_;
      ++words;
    } else if (c == ')' || c == '}') {
      if (depth == 0) fail("';' expected");
      --depth;
      ++at_;
      if (c == '}' && depth == 0) break;  // a dictionary has no ';'
    } else if (c == ';') {
      ++at_;
    } else {
      word = read_word();
      ++words;
    }
  }
  if (plain) *plain = words == 1 ? word : std::string();
}

Offset FoamFile::read_integer() {
  skip_space();
  Offset value = 0;
  const char* end = text_.data() + text_.size();
  const auto [stop, error] = std::from_chars(text_.data() + at_, end, value);
  if (error != std::errc()) fail("a whole number expected");
  if (stop != end && !ends_word(*stop) && *stop != '/') fail("a whole number expected");
  at_ = static_cast<std::size_t>(stop - text_.data());
  return value;
}

double FoamFile::read_real() {
  skip_space();
  if (at_ < text_.size() && text_[at_] == '+') ++at_;
  double value = 0;
  const char* end = text_.data() + text_.size();
  const auto [stop, error] = std::from_chars(text_.data() + at_, end, value);
  if (error != std::errc() || !std::isfinite(value)) fail("a finite number expected");
  if (stop != end && !ends_word(*stop) && *stop != '/') fail("a number expected");
  at_ = static_cast<std::size_t>(stop - text_.data());
  return value;
}

std::size_t FoamFile::read_length(std::size_t item_bytes) {
  skip_space();
  const std::size_t start = at_;
  const Offset length = read_integer();
  skip_space();
  const bool uniform = at_ < text_.size() && text_[at_] == '{';
  const std::size_t left = text_.size() - at_;
  // A uniform list is short whatever its length: no polyMesh of ours or theirs needs a long one.
  if (length < 0 || length > std::numeric_limits<Index>::max() ||
      (uniform ? length > Offset{1'000'000} : static_cast<std::size_t>(length) > left / item_bytes)) {
    fail(start, fmt::format("a list claims {} items, but {} bytes are left", length, left), remake);
  }
  return static_cast<std::size_t>(length);
}

const char* FoamFile::read_raw(std::size_t bytes) {
  if (bytes > text_.size() - at_) fail("binary data are cut off");
  const char* data = text_.data() + at_;
  at_ += bytes;
  return data;
}

Index FoamFile::raw_label(const char* bytes) const {
  if (label_bytes_ == 4) {
    std::int32_t value = 0;
    std::memcpy(&value, bytes, 4);
    return value;
  }
  std::int64_t value = 0;
  std::memcpy(&value, bytes, 8);
  const bool fits = value >= -1 && value <= std::numeric_limits<Index>::max();
  return fits ? static_cast<Index>(value) : std::numeric_limits<Index>::min();  // out of every range
}

std::vector<Index> FoamFile::read_labels() {
  std::vector<Index> labels;
  read_labels_into(labels);
  return labels;
}

void FoamFile::read_labels_into(std::vector<Index>& labels) {
  const std::size_t length = read_length(binary_ ? label_bytes_ : 2);
  labels.resize(length);
  const auto checked = [&] {
    const Offset value = read_integer();
    if (value < std::numeric_limits<Index>::min() || value > std::numeric_limits<Index>::max()) {
      fail("a label of 32 bits expected");
    }
    return static_cast<Index>(value);
  };
  if (accept('{')) {
    const Index value = checked();
    labels.assign(length, value);
    expect('}');
    return;
  }
  if (length == 0) {
    if (accept('(')) expect(')');
    return;
  }
  expect('(');
  if (binary_) {
    const char* data = read_raw(length * label_bytes_);
    for (std::size_t i = 0; i < length; ++i) labels[i] = raw_label(data + i * label_bytes_);
  } else {
    for (Index& label : labels) label = checked();
  }
  expect(')');
}

std::vector<Vec3> FoamFile::read_points() {
  const std::size_t length = read_length(binary_ ? 3 * scalar_bytes_ : 7);
  std::vector<Vec3> points(length);
  if (length == 0) return points;
  expect('(');
  if (!binary_) {
    for (Vec3& p : points) {
      expect('(');
      for (int d = 0; d < 3; ++d) p[d] = read_real();
      expect(')');
    }
    expect(')');
    return points;
  }
  const std::size_t start = at_;
  const char* data = read_raw(length * 3 * scalar_bytes_);
  for (std::size_t i = 0; i < length; ++i) {
    for (int d = 0; d < 3; ++d) {
      const char* bytes = data + (3 * i + static_cast<std::size_t>(d)) * scalar_bytes_;
      if (scalar_bytes_ == 8) {
        std::memcpy(&points[i][d], bytes, 8);
      } else {
        float value = 0;
        std::memcpy(&value, bytes, 4);
        points[i][d] = value;
      }
    }
    if (!points[i].allFinite()) {
      fail(start + i * 3 * scalar_bytes_, fmt::format("point {} is not finite", i), remake);
    }
  }
  expect(')');
  return points;
}

std::vector<std::array<Index, 4>> FoamFile::read_quads() {
  const auto refuse = [&](std::size_t face, Offset corners) {
    fail(at_, fmt::format("face {} has {} points: not a hex mesh", face, corners),
         "flowcage reads meshes of hexes with four-sided faces only");
  };
  std::vector<std::array<Index, 4>> quads;
  if (header("class") == "faceCompactList") {
    const std::vector<Index> starts = read_labels();
    const std::vector<Index> corners = read_labels();
    if (starts.empty()) return quads;
    quads.resize(starts.size() - 1);
    for (std::size_t f = 0; f < quads.size(); ++f) {
      const Offset begin = starts[f], end = starts[f + 1];
      if (begin < 0 || end < begin || end > static_cast<Offset>(corners.size())) {
        fail(at_, fmt::format("face {} is said to have points {} to {} of {}", f, begin, end, corners.size()),
             remake);
      }
      if (end - begin != 4) refuse(f, end - begin);
      std::copy_n(corners.begin() + begin, 4, quads[f].begin());
    }
    return quads;
  }
  const std::size_t length = read_length(binary_ ? 4 + 4 * label_bytes_ : 10);
  quads.resize(length);
  if (length == 0) return quads;
  expect('(');
  std::vector<Index> corners;
  for (std::size_t f = 0; f < length; ++f) {
    read_labels_into(corners);
    if (corners.size() != 4) refuse(f, static_cast<Offset>(corners.size()));
    std::copy_n(corners.begin(), 4, quads[f].begin());
  }
  expect(')');
  return quads;
}

std::vector<FoamFile::Entry> FoamFile::read_entries() {
  const std::size_t length = read_length(3);
  std::vector<Entry> entries;
  if (!accept('(')) {
    if (length == 0) return entries;
    fail("'(' expected");
  }
  for (std::size_t i = 0; i < length; ++i) {
    Entry entry;
    skip_space();
    entry.position = at_;
    entry.name = read_word();
    if (entry.name.empty()) fail("a patch's name expected");
    expect('{');
    while (!accept('}')) {
      const std::string key = read_word();
      if (key.empty()) fail("a keyword expected");
      skip_value(&entry.values[key]);
    }
    entries.push_back(std::move(entry));
  }
  expect(')');
  return entries;
}

}  // namespace flowcage
