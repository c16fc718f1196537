// Damaged files cost a child process, never this one.
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/isolate.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/occ_bridge/cad_scratch.hpp"

using namespace flowcage;

namespace {

Error error_of_child(const std::function<std::string()>& work, double limit_seconds = 60) {
  Progress silent;
  try {
    occ::run_isolated(work, {.file = "part.step", .stage = "read", .limit_seconds = limit_seconds}, silent);
  } catch (const Error& error) {
    return error;
  }
  FAIL("no error");
  return {ErrorKind::internal, "", ""};
}

/// Flipped bits, cut-out middles, other digits, moved pieces.
std::string damaged(std::string text, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  switch (seed % 4) {
    case 0:
      for (std::size_t n = 1 + below(20); n > 0; --n) text[below(text.size())] ^= char(1 << below(8));
      break;
    case 1: {
      const std::string tail = text.substr(text.size() - 100);
      text = text.substr(0, below(text.size())) + tail;
      break;
    }
    case 2:
      for (std::size_t n = 1 + below(40); n > 0; --n) {
        const std::size_t digit = text.find_first_of("0123456789", below(text.size()));
        if (digit != std::string::npos) text[digit] = static_cast<char>('0' + below(10));
      }
      break;
    default: {
      const std::size_t to = below(text.size()), from = below(text.size()), length = below(200);
      const std::string piece = text.substr(from, length);
      text.replace(to, std::min(length, text.size() - to), piece);
    }
  }
  return text;
}

}  // namespace

TEST_CASE("a child's result comes back whole") {
  Progress silent;
  std::string large(3 << 20, 'x');
  for (std::size_t i = 0; i < large.size(); i += 7) large[i] = static_cast<char>(i % 251);
  CHECK(occ::run_isolated([&] { return large; }, {.file = "f", .stage = "s"}, silent) == large);
  CHECK(occ::run_isolated([] { return std::string(); }, {.file = "f", .stage = "s"}, silent).empty());
}

TEST_CASE("a child that throws, crashes, stops or hangs is an error that names the file") {
  const Error thrown =
      error_of_child([]() -> std::string { throw Error(ErrorKind::usage, "what it is", "what to do"); });
  CHECK(thrown.kind() == ErrorKind::usage);
  CHECK(std::string(thrown.what()) == "what it is");
  CHECK(thrown.remedy() == "what to do");

  const auto failed = [](const Error& error, const std::string& why) {
    CHECK(error.kind() == ErrorKind::input);
    CHECK(std::string(error.what()).find("part.step: ") == 0);
    CHECK(std::string(error.what()).find(why) != std::string::npos);
  };
  failed(error_of_child([]() -> std::string {
           std::raise(SIGSEGV);
           std::abort();
         }),
         "crashed");
  failed(error_of_child([]() -> std::string { std::abort(); }), "crashed");
  failed(error_of_child([]() -> std::string { std::_Exit(7); }), "without a result");
  failed(error_of_child([]() -> std::string { throw std::bad_alloc(); }), "memory");
  failed(error_of_child([]() -> std::string { throw std::runtime_error("odd"); }), "odd");
  failed(error_of_child(
             []() -> std::string {
               for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
             },
             0.3),
         "more than 0.3 s");
}

TEST_CASE("cancelling ends a child at once") {
  struct Impatient : Progress {
    mutable int asked = 0;
    bool cancelled() const override { return ++asked > 2; }
  } impatient;
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(occ::run_isolated(
                      []() -> std::string {
                        std::this_thread::sleep_for(std::chrono::seconds(30));
                        return "";
                      },
                      {.file = "f", .stage = "s"}, impatient),
                  Error);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
}

TEST_CASE("damaged files are read or refused, and never crash or hang the program") {
  const Scratch scratch;
  HalfWing wing;
  wing.airfoil = naca_symmetric(0.12, 0.002);
  write_cad(make_half_wing(wing), scratch.file("whole.step"), "mm");
  write_cad(make_difference(make_box({1, 1, 1}), make_cylinder(0.3, 1)), scratch.file("whole.igs"), "mm");
  write_cad(make_rounded_box({1, 1, 1}, 0.2), scratch.file("whole.brep"));
  int read = 0, refused = 0;
  for (const char* extension : {".step", ".igs", ".brep"}) {
    const std::string whole = text_of(scratch.file(std::string("whole") + extension));
    for (unsigned seed = 0; seed < 34; ++seed) {
      const std::string file = scratch.write(std::string("damaged") + extension, damaged(whole, seed));
      CAPTURE(extension, seed);
      CadReadSettings settings;
      settings.time_limit_seconds = 3;
      Progress silent;
      try {
        const CadModel model = read_cad({&file, 1}, settings, silent);
        CHECK(model.face_count() > 0);
        CHECK(model.bounds().diagonal().allFinite());
        ++read;
      } catch (const Error& error) {
        CHECK(error.kind() == ErrorKind::input);
        CHECK(std::string(error.what()).find(file) == 0);
        ++refused;
      }
    }
  }
  CHECK(read > 10);
  CHECK(refused > 10);
}
