#include "core/export/vtk_xml_reader.hpp"

#include <fmt/format.h>
#ifdef FLOWCAGE_USE_ZLIB
#include <zlib.h>
#endif

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/export/file_text.hpp"

namespace flowcage {
namespace {

constexpr const char* remake = "write the file again with the program that made it";

bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

// Decodes groups of four characters, at most `limit` bytes, up to the first character that is no base64. A
// padded group does not end the data: VTK pads header and data each. `used`: characters read.
std::string decode_base64(std::string_view text, std::size_t limit, std::size_t& used) {
  std::string bytes;
  std::array<int, 4> group{};
  int filled = 0, padding = 0;
  used = 0;
  while (used < text.size() && bytes.size() < limit) {
    const char c = text[used];
    if (is_space(c)) {
      ++used;
      continue;
    }
    const int value = c == '=' ? 0 : base64_value(c);
    if (value < 0) break;
    padding += c == '=';
    group[filled++] = value;
    ++used;
    if (filled < 4) continue;
    const int word = (group[0] << 18) | (group[1] << 12) | (group[2] << 6) | group[3];
    for (int i = 0; i < 3 - padding && bytes.size() < limit; ++i) {
      bytes += static_cast<char>((word >> (16 - 8 * i)) & 255);
    }
    filled = padding = 0;
  }
  return bytes;
}

std::uint64_t unsigned_at(std::string_view bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, width);
  return value;
}

std::string unescaped(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> entities{
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string plain;
  for (std::size_t i = 0; i < text.size();) {
    const auto it = std::find_if(entities.begin(), entities.end(),
                                 [&](const auto& e) { return text.substr(i).starts_with(e.first); });
    plain += it == entities.end() ? text[i] : it->second;
    i += it == entities.end() ? 1 : it->first.size();
  }
  return plain;
}

}  // namespace

VtkXmlFile::VtkXmlFile(const std::string& file, const std::string& type)
    : name_(file), text_(read_whole_file(file)) {
  parse_elements();
  check_encoding(type);
}

void VtkXmlFile::fail(const Element& element, const std::string& what, const std::string& remedy) const {
  throw input_error(name_, line_of(text_, element.position), what, remedy);
}

VtkXmlFile::Element VtkXmlFile::parse_tag(std::size_t& at, bool& closed) const {
  const auto name_ends = [](char c) { return is_space(c) || c == '>' || c == '/' || c == '='; };
  Element element;
  element.position = at++;
  const auto require = [&](bool good) {
    if (!good) fail(element, fmt::format("bad XML near \"{}\"", excerpt(text_, element.position)), remake);
  };
  const auto skip_space = [&] {
    while (at < text_.size() && is_space(text_[at])) ++at;
  };
  while (at < text_.size() && !name_ends(text_[at])) element.name += text_[at++];
  require(!element.name.empty());
  while (true) {
    skip_space();
    require(at < text_.size());
    closed = text_[at] == '/';
    if (closed) ++at;
    require(at < text_.size());
    if (text_[at] == '>') break;
    require(!closed);
    std::string key;
    while (at < text_.size() && !name_ends(text_[at])) key += text_[at++];
    skip_space();
    require(!key.empty() && at < text_.size() && text_[at] == '=');
    ++at;
    skip_space();
    require(at < text_.size() && (text_[at] == '"' || text_[at] == '\''));
    const auto end = text_.find(text_[at], at + 1);
    require(end != std::string::npos);
    element.attributes[key] = unescaped(std::string_view(text_).substr(at + 1, end - at - 1));
    at = end + 1;
  }
  element.text_begin = element.text_end = ++at;
  return element;
}

void VtkXmlFile::parse_elements() {
  std::vector<std::size_t> open;
  std::size_t text_begin = 0;  // where the text between the last tag and the next begins
  // VTK puts child elements (InformationKey) beside the numbers.
  const auto end_text = [&](std::size_t at) {
    if (open.empty()) return;
    Element& element = elements_[open.back()];
    const std::string_view text = std::string_view(text_).substr(text_begin, at - text_begin);
    if (element.text_begin != element.text_end || std::all_of(text.begin(), text.end(), is_space)) return;
    element.text_begin = text_begin;
    element.text_end = at;
  };
  const auto refuse = [&](std::size_t at, const std::string& what) {
    throw input_error(name_, line_of(text_, at), what, remake);
  };
  for (std::size_t at = 0; (at = text_.find('<', at)) != std::string::npos;) {
    if (text_.compare(at, 4, "<!--") == 0 || text_.compare(at, 2, "<?") == 0) {
      const char* const end = text_[at + 1] == '?' ? "?>" : "-->";
      const auto stop = text_.find(end, at + 2);
      if (stop == std::string::npos) refuse(at, "a comment or declaration has no end");
      at = stop + std::strlen(end);
    } else if (text_.compare(at, 2, "</") == 0) {
      const auto stop = text_.find('>', at);
      if (stop == std::string::npos || open.empty() ||
          text_.compare(at + 2, elements_[open.back()].name.size(), elements_[open.back()].name) != 0) {
        refuse(at, fmt::format("the end tag \"{}\" closes nothing", excerpt(text_, at)));
      }
      end_text(at);
      open.pop_back();
      text_begin = at = stop + 1;
    } else {
      end_text(at);
      bool closed = false;
      Element element = parse_tag(at, closed);
      text_begin = at;
      if (!open.empty()) element.parent = elements_[open.back()].name;
      elements_.push_back(std::move(element));
      if (elements_.back().name == "AppendedData") {
        // Bytes, not XML. They begin behind an underscore.
        const auto start = text_.find('_', at);
        if (start == std::string::npos) refuse(at, "the appended data are missing");
        elements_.back().text_begin = start + 1;
        elements_.back().text_end = text_.size();
        return;
      }
      if (!closed) open.push_back(elements_.size() - 1);
      if (open.size() > 100) refuse(at, "elements are nested too deep");
    }
  }
  if (!open.empty()) {
    refuse(text_.size(), fmt::format("the file ends inside of element {}", elements_[open.back()].name));
  }
}

void VtkXmlFile::check_encoding(const std::string& type) {
  if (elements_.empty() || elements_[0].name != "VTKFile") {
    throw input_error(name_, 0, "is no VTK XML file (no VTKFile element)",
                      "give a .vtu file, as VTK, ParaView or meshio write it");
  }
  const Element& file = elements_[0];
  if (file.attribute("type") != type) {
    fail(file, fmt::format("holds a {}, not an {}", file.attribute("type"), type),
         "save the volume mesh as unstructured grid (.vtu)");
  }
  if (file.attribute("byte_order") == "BigEndian") {
    fail(file, "is big-endian", "save it as ASCII where it was written");
  }
  if (file.attribute("header_type") == "UInt64") header_bytes_ = 8;
  const std::string compressor = file.attribute("compressor");
  if (compressor.empty()) return;
  compressed_ = true;
#ifdef FLOWCAGE_USE_ZLIB
  if (compressor == "vtkZLibDataCompressor") return;
#endif
  fail(file, fmt::format("is compressed by {}", compressor), "save it without compression");
}

// The bytes of an array's numbers, whatever form they are stored in.
std::string VtkXmlFile::decode(const Element& array) const {
  std::string_view stored;
  bool base64 = true;
  if (array.attribute("format") == "binary") {
    stored = std::string_view(text_).substr(array.text_begin, array.text_end - array.text_begin);
  } else {
    const Element& appended = elements_.back();
    if (appended.name != "AppendedData") fail(array, "the appended data are missing", remake);
    const std::string_view all = std::string_view(text_).substr(appended.text_begin);
    const std::string given = array.attribute("offset");
    std::size_t offset = 0;
    const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), offset);
    if (error != std::errc() || end != given.data() + given.size() || offset > all.size()) {
      fail(array, fmt::format("offset \"{}\" lies outside of the file's {} bytes of data", given, all.size()),
           remake);
    }
    stored = all.substr(offset);
    base64 = appended.attribute("encoding") != "raw";
  }
  if (compressed_) return decompress(array, stored, base64);
  std::size_t used = 0;
  const std::string header =
      base64 ? decode_base64(stored, header_bytes_, used) : std::string(stored.substr(0, header_bytes_));
  if (header.size() < header_bytes_) fail(array, "an array's data are missing", remake);
  const std::uint64_t size = unsigned_at(header, 0, header_bytes_);
  if (size > stored.size()) {
    fail(array, fmt::format("an array claims {} bytes, but {} are left", size, stored.size()), remake);
  }
  std::string bytes = base64 ? decode_base64(stored, header_bytes_ + size, used)
                             : std::string(stored.substr(0, header_bytes_ + size));
  if (bytes.size() != header_bytes_ + size) fail(array, "an array's data are cut off", remake);
  return bytes.substr(header_bytes_);
}

std::string VtkXmlFile::decompress([[maybe_unused]] const Element& array,
                                   [[maybe_unused]] std::string_view stored,
                                   [[maybe_unused]] bool base64) const {
#ifdef FLOWCAGE_USE_ZLIB
  const std::size_t w = header_bytes_;
  std::size_t used = 0;
  // Number of blocks, size of a block, size of a partial last block (0: none), then each block's packed size.
  const std::string start = base64 ? decode_base64(stored, w, used) : std::string(stored.substr(0, w));
  if (start.size() < w) fail(array, "an array's data are missing", remake);
  const std::uint64_t blocks = unsigned_at(start, 0, w);
  if (blocks > stored.size() / w) fail(array, fmt::format("an array claims {} blocks", blocks), remake);
  const std::size_t head_size = (3 + blocks) * w;
  const std::string head =
      base64 ? decode_base64(stored, head_size, used) : std::string(stored.substr(0, head_size));
  if (blocks == 0) return {};
  if (head.size() < head_size) fail(array, "an array's block sizes are cut off", remake);
  if (!base64) used = head_size;
  const std::uint64_t block_size = unsigned_at(head, w, w), partial = unsigned_at(head, 2 * w, w);
  std::uint64_t packed_size = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t size = unsigned_at(head, (3 + b) * w, w);
    if (size > stored.size() - packed_size) fail(array, "an array's data are cut off", remake);
    packed_size += size;
  }
  stored = stored.substr(std::min(used, stored.size()));
  const std::string packed =
      base64 ? decode_base64(stored, packed_size, used) : std::string(stored.substr(0, packed_size));
  if (packed.size() < packed_size) fail(array, "an array's data are cut off", remake);
  std::string bytes;
  std::size_t at = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t size = unsigned_at(head, (3 + b) * w, w);
    const std::uint64_t full = b + 1 == blocks && partial != 0 ? partial : block_size;
    // zlib packs at most 1032 times.
    if (full / 1040 > size + 64) {
      fail(array, fmt::format("block {} claims {} bytes packed into {}", b, full, size), remake);
    }
    const std::size_t before = bytes.size();
    bytes.resize(before + full);
    uLongf got = static_cast<uLongf>(full);
    const int result =
        uncompress(reinterpret_cast<Bytef*>(bytes.data() + before), &got,
                   reinterpret_cast<const Bytef*>(packed.data() + at), static_cast<uLong>(size));
    if (result != Z_OK || got != full) fail(array, fmt::format("block {} cannot be unpacked", b), remake);
    at += size;
  }
  return bytes;
#else
  fail(array, "is compressed", "save it without compression");
#endif
}

template <typename Number>
std::vector<Number> VtkXmlFile::read(const Element& array) const {
  std::vector<Number> numbers;
  const std::string format = array.attribute("format"), type = array.attribute("type");
  if (format == "ascii" || format.empty()) {
    const char* at = text_.data() + array.text_begin;
    const char* const end = text_.data() + array.text_end;
    while (true) {
      while (at < end && is_space(*at)) ++at;
      if (at == end) return numbers;
      Number value{};
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error != std::errc() || (stop < end && !is_space(*stop))) {
        const auto position = static_cast<std::size_t>(at - text_.data());
        throw input_error(name_, line_of(text_, position),
                          fmt::format("a number of array {} expected, found \"{}\"", array.attribute("Name"),
                                      excerpt(text_, position)),
                          remake);
      }
      numbers.push_back(value);
      at = stop;
    }
  }
  if (format != "binary" && format != "appended") {
    fail(array, fmt::format("format \"{}\" is unknown", format), remake);
  }
  const std::string bytes = decode(array);
  const auto convert = [&]<typename Stored>(Stored) {
    if constexpr (std::is_integral_v<Number> && std::is_floating_point_v<Stored>) {
      fail(array, fmt::format("array {} must hold whole numbers", array.attribute("Name")), remake);
    } else {
      if (bytes.size() % sizeof(Stored) != 0) fail(array, "an array's data are cut off", remake);
      numbers.resize(bytes.size() / sizeof(Stored));
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        Stored value;
        std::memcpy(&value, bytes.data() + i * sizeof(Stored), sizeof(Stored));
        numbers[i] = static_cast<Number>(value);
      }
    }
  };
  if (type == "Float64") {
    convert(double{});
  } else if (type == "Float32") {
    convert(float{});
  } else if (type == "Int64") {
    convert(std::int64_t{});
  } else if (type == "UInt64") {
    convert(std::uint64_t{});
  } else if (type == "Int32") {
    convert(std::int32_t{});
  } else if (type == "UInt32") {
    convert(std::uint32_t{});
  } else if (type == "Int16") {
    convert(std::int16_t{});
  } else if (type == "UInt16") {
    convert(std::uint16_t{});
  } else if (type == "Int8") {
    convert(std::int8_t{});
  } else if (type == "UInt8") {
    convert(std::uint8_t{});
  } else {
    fail(array, fmt::format("array type \"{}\" is unknown", type), remake);
  }
  return numbers;
}

std::vector<double> VtkXmlFile::read_reals(const Element& array) const {
  return read<double>(array);
}

std::vector<std::int64_t> VtkXmlFile::read_integers(const Element& array) const {
  return read<std::int64_t>(array);
}

}  // namespace flowcage
