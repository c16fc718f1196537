#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/types.hpp"

namespace flowcage {

/// The words and numbers of a text file, one after the other. Everything that is not as asked for throws
/// Error(input) with the file as given, the line, what stands there and the remedy.
class TextScanner {
 public:
  /// Reads the whole file; throws Error(input) if it cannot be read.
  explicit TextScanner(const std::filesystem::path& file);

  /// The next word (no white space); empty at the end of the file.
  std::string_view word();
  /// The rest of the current line without its end, and moves behind it.
  std::string_view line();
  /// Gives back the last `bytes` bytes of the last word, for words that hang together ("NDIME=3").
  void step_back(std::size_t bytes) { next_ -= bytes; }
  bool at_end();

  Offset integer(const char* what);
  double real(const char* what);
  /// Three coordinates, all finite.
  Vec3 point();
  /// A number of things that each take at least `bytes` bytes of text: refused if it is negative, more than
  /// Index holds, or if the rest of the file is too short for it. So a damaged number never makes the caller
  /// take more memory than in proportion to the file.
  Offset count(const char* what, std::size_t bytes);

  /// Throws Error(input) for the line of the last word.
  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;

 private:
  std::string file_, text_;
  std::size_t next_ = 0;  ///< behind the last word
  std::size_t last_ = 0;  ///< where the last word or line began
};

}  // namespace flowcage
