#include "occ_bridge/internal/select_faces.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <BRepTools_ReShape.hxx>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <map>
#include <string_view>

#include "core/base/suggestion.hpp"

namespace flowcage::occ {

namespace {

struct Field {
  std::string_view prefix;  ///< without its colon
  std::string CadFace::*value;
};
constexpr std::array<Field, 8> fields{{{"name", &CadFace::name},
                                       {"solid", &CadFace::solid},
                                       {"part", &CadFace::part},
                                       {"instance", &CadFace::instance},
                                       {"layer", &CadFace::layer},
                                       {"color", &CadFace::color},
                                       {"file", &CadFace::file},
                                       {"group", &CadFace::group}}};

struct NumberRange {
  Index first = 0, last = 0;
};

struct Pattern {
  std::string option, text;            ///< as given
  std::string CadFace::*field = {};    ///< null: any of them
  std::string wildcard{};              ///< of names
  std::vector<NumberRange> numbers{};  ///< not empty: by number
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

[[noreturn]] void refuse(const Pattern& pattern, const std::string& why, std::string remedy) {
  throw Error(ErrorKind::usage, fmt::format("--{} \"{}\": {}", pattern.option, pattern.text, why),
              std::move(remedy));
}

/// "3", "1-4", "1-4,9"
std::vector<NumberRange> parse_numbers(const Pattern& pattern, std::string_view text) {
  const auto number = [&](std::string_view word) {
    Index value = 0;
    const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (code != std::errc() || stop != word.data() + word.size() || value < 1) {
      refuse(pattern, fmt::format("\"{}\" is no face number", word), "give face:3 or face:1-4,9");
    }
    return value;
  };
  std::vector<NumberRange> ranges;
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::string_view word = text.substr(0, comma);
    const std::size_t dash = word.find('-');
    const Index first = number(word.substr(0, dash));
    const Index last = dash == std::string_view::npos ? first : number(word.substr(dash + 1));
    if (last < first) refuse(pattern, "its numbers descend", "give the smaller one first");
    ranges.push_back({first, last});
    if (comma == std::string_view::npos) return ranges;
    text.remove_prefix(comma + 1);
  }
}

Pattern parse(const std::string& option, const std::string& text) {
  Pattern pattern{.option = option, .text = text, .wildcard = text};
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return pattern;
  const std::string prefix = lower(text.substr(0, colon)), rest = text.substr(colon + 1);
  if (prefix == "face") {
    pattern.numbers = parse_numbers(pattern, rest);
    return pattern;
  }
  const auto* known = std::ranges::find(fields, prefix == "colour" ? "color" : prefix, &Field::prefix);
  if (known == fields.end()) return pattern;  // a colon may be part of a name
  pattern.field = known->value;
  pattern.wildcard = rest;
  return pattern;
}

bool name_matches(const std::string& wildcard, const std::string& name) {
  return !name.empty() && fnmatch(wildcard.c_str(), name.c_str(), 0) == 0;
}

bool matches(const Pattern& pattern, const CadFace& face) {
  if (!pattern.numbers.empty()) {
    return std::ranges::any_of(pattern.numbers, [&](const NumberRange& range) {
      return range.first <= face.number && face.number <= range.last;
    });
  }
  return std::ranges::any_of(fields, [&](const Field& field) {
    if (pattern.field != nullptr && pattern.field != field.value) return false;
    const bool any_case = field.value == &CadFace::color;
    return name_matches(any_case ? lower(pattern.wildcard) : pattern.wildcard, face.*field.value);
  });
}

/// "wing* matches no face" with what there is: the nearest word, then all of them with their numbers.
[[noreturn]] void refuse_unmatched(const Pattern& pattern, const std::vector<CadFace>& faces) {
  if (!pattern.numbers.empty()) {
    refuse(pattern, fmt::format("the CAD has the faces 1 to {}", faces.size()),
           "`flowcage inspect` shows which is which");
  }
  std::vector<std::string> words;
  std::map<std::string, Index> counts;
  for (const Field& field : fields) {
    if (pattern.field != nullptr && pattern.field != field.value) continue;
    for (const CadFace& face : faces) {
      const std::string& value = face.*field.value;
      if (value.empty()) continue;
      if (std::ranges::find(words, value) == words.end()) words.push_back(value);
      ++counts[fmt::format("{}:{}", field.prefix, value)];
    }
  }
  const std::string nearest = suggestion(pattern.wildcard, words);
  std::string remedy = nearest.empty() ? "" : fmt::format("did you mean \"{}\"? ", nearest);
  if (counts.empty()) {
    refuse(pattern, "no face has such a name, layer or colour",
           remedy + "choose by number, as in face:1-4; `flowcage inspect` shows which is which");
  }
  constexpr std::size_t listed = 30;
  remedy += "there are";
  std::size_t shown = 0;
  for (const auto& [word, count] : counts) {
    if (shown++ == listed) break;
    remedy += fmt::format("\n  {} ({} face{})", word, count, count == 1 ? "" : "s");
  }
  if (counts.size() > listed)
    remedy += fmt::format("\n  and {} more, see flowcage inspect", counts.size() - listed);
  refuse(pattern, "it matches no face", remedy);
}

std::vector<Pattern> patterns_of(const std::string& option, const std::vector<std::string>& texts,
                                 const std::vector<CadFace>& faces) {
  std::vector<Pattern> patterns;
  for (const std::string& text : texts) {
    const Pattern& pattern = patterns.emplace_back(parse(option, text));
    if (std::ranges::none_of(faces, [&](const CadFace& face) { return matches(pattern, face); })) {
      refuse_unmatched(pattern, faces);
    }
  }
  return patterns;
}

}  // namespace

void name_faces(std::vector<CadFace>& faces, std::span<const CadReadSettings::NamedFaces> named) {
  std::vector<std::pair<Pattern, std::string>> names;  // before any of them becomes a group
  for (const CadReadSettings::NamedFaces& n : named) {
    names.emplace_back(patterns_of(n.option, {n.pattern}, faces).front(), n.name);
  }
  const std::vector<CadFace> before = faces;
  for (const auto& [pattern, name] : names) {
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (matches(pattern, before[f])) faces[f].group = name;
    }
  }
}

Index select_faces(std::vector<FileContent>& contents, const FaceLabels& labels,
                   const FaceSelection& selection) {
  if (selection.include.empty() && selection.exclude.empty()) return 0;
  std::vector<CadFace> faces;
  std::vector<std::vector<TopoDS_Shape>> shapes;
  for (const FileContent& content : contents) {
    for (const TopoDS_Shape& shape : shapes.emplace_back(faces_of(content.shape))) {
      faces.push_back(labels.of(shape));
    }
  }
  choose_groups(faces);
  const std::vector<Pattern> include = patterns_of("include", selection.include, faces);
  const std::vector<Pattern> exclude = patterns_of("exclude", selection.exclude, faces);
  const auto any = [](const std::vector<Pattern>& patterns, const CadFace& face) {
    return std::ranges::any_of(patterns, [&](const Pattern& pattern) { return matches(pattern, face); });
  };
  Index removed = 0;
  std::size_t f = 0;
  std::vector<FileContent> kept;
  for (std::size_t c = 0; c < contents.size(); ++c) {
    const Handle(BRepTools_ReShape) context = new BRepTools_ReShape;
    int left = 0;
    for (const TopoDS_Shape& shape : shapes[c]) {
      const CadFace& face = faces[f++];
      const bool keep = (include.empty() || any(include, face)) && !any(exclude, face);
      left += keep ? 1 : 0;
      removed += keep ? 0 : 1;
      if (!keep) context->Remove(shape);
    }
    if (left == 0) continue;
    kept.push_back(contents[c]);
    kept.back().shape = context->Apply(contents[c].shape);
  }
  if (kept.empty()) {
    throw Error(ErrorKind::usage, "--include and --exclude leave no face of the CAD",
                "`flowcage inspect` without them shows the faces and their names");
  }
  contents = std::move(kept);
  return removed;
}

}  // namespace flowcage::occ
