// Random damage to a cage file: the outcome is a usable cage or a message, never anything else.
#include <random>
#include <sstream>

#include "core/base/error.hpp"
#include "core/cage/read_cage.hpp"
#include "core/cage/write_cage.hpp"
#include "core/mesh/manifold_check.hpp"
#include "tests/cage/cage_samples.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  void mutate(std::string& text) {
    switch (below(7)) {
      case 0:  // any byte
        if (!text.empty()) text[below(text.size())] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(below(text.size() + 1), below(20));
        break;
      case 2:
        text.insert(below(text.size() + 1), pieces[below(pieces.size())]);
        break;
      case 3: {  // copy a piece elsewhere
        const std::string piece = text.substr(below(text.size() + 1), below(60));
        text.insert(below(text.size() + 1), piece);
        break;
      }
      case 4:
        text.resize(below(text.size() + 1));
        break;
      case 5: {  // change a digit: other vertices, other tags
        const std::size_t at = text.find_first_of("0123456789", below(text.size() + 1));
        if (at != std::string::npos) text[at] = static_cast<char>('0' + below(10));
        break;
      }
      default:  // only white space and line ends change
        if (const std::size_t at = text.find_first_of(" \n", below(text.size() + 1));
            at != std::string::npos) {
          text[at] = " \n\t\r"[below(4)];
        }
    }
  }
  std::size_t below(std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random_);
  }

 private:
  const std::vector<std::string> pieces{"\n",
                                        "f 1 2 3\n",
                                        "\\\n",
                                        "\\",
                                        "v 1e308 -1e308 1\n",
                                        "nan",
                                        "-",
                                        "/",
                                        "//",
                                        "l 1 2\n",
                                        "t crease 2/1/0 0 1 1e30\n",
                                        "t corner 1/1/0 0 -1\n",
                                        "2147483648",
                                        "-2147483649",
                                        "9223372036854775808",
                                        "\xEF\xBB\xBF",
                                        "\r",
                                        "#",
                                        "g\n",
                                        "t crease 2147483646/1/0 0\n",
                                        "1e-400",
                                        "0x10",
                                        "\x7f"};
  std::mt19937 random_;
};

}  // namespace

TEST_CASE("read_cage survives random damage") {
  int usable = 0, refused = 0;
  for (unsigned seed = 0; seed < 20000; ++seed) {
    Mutator mutator(seed);
    std::string text = prism_text;
    for (std::size_t i = mutator.below(6) + 1; i > 0; --i) mutator.mutate(text);
    try {
      const Cage cage = parse_cage(text, "fuzz.obj");
      ++usable;
      if (find_manifold_defect(cage)) FAIL("a defect passed, seed " << seed);
      std::ostringstream out;
      write_cage(cage, out);
      const Cage again = parse_cage(out.str(), "again.obj");
      if (again.points != cage.points || again.faces != cage.faces || again.creases != cage.creases) {
        FAIL("not written back without loss, seed " << seed);
      }
    } catch (const Error& e) {
      ++refused;
      const std::string what = e.what();
      if (e.kind() != ErrorKind::input || !what.starts_with("fuzz.obj") ||
          what.find('\n') != std::string::npos) {
        FAIL("a poor message, seed " << seed << ": " << what);
      }
    }
  }
  CHECK(usable > 1000);
  CHECK(refused > 1000);
}
