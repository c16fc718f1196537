#include "core/base/atomic_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "core/base/error.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
namespace fs = std::filesystem;

namespace {

/// A fresh folder that vanishes with the test.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("flowcage_atomic_" + std::to_string(::getpid()));
  Folder() {
    fs::remove_all(path);
    fs::create_directory(path);
  }
  ~Folder() { fs::remove_all(path); }
  long entries() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
};

void put(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
}
std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <typename Call>
void check_output_error(const Call& call, const std::string& text) {
  try {
    call();
    FAIL("no exception");
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::output);
    CHECK_THAT(e.what(), contains_text(text));
    CHECK_FALSE(e.remedy().empty());
  }
}

}  // namespace

TEST_CASE("atomic file: the target changes at commit only, and keeps its permissions") {
  const Folder folder;
  const fs::path target = folder.path / "mesh.obj";
  put(target, "old");
  ::chmod(target.c_str(), 0640);
  {
    AtomicFile file(target);
    file.stream() << "lost";
  }
  CHECK(text_of(target) == "old");
  CHECK(folder.entries() == 1);
  {
    AtomicFile file(target);
    CHECK(file.path().extension() == ".obj");
    file.stream() << "new " << 7;
    CHECK(text_of(target) == "old");
    file.commit();
  }
  CHECK(text_of(target) == "new 7");
  CHECK(folder.entries() == 1);
  struct stat status {};
  REQUIRE(::stat(target.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
}

TEST_CASE("atomic file: more than the buffer, and writers that take a path") {
  const Folder folder;
  const std::string line(1000, 'x');
  AtomicFile streamed(folder.path / "a");
  for (int i = 0; i < 1000; ++i) streamed.stream() << line << '\n';
  streamed.stream().write(std::string(1 << 20, 'y').data(), 1 << 20);
  streamed.commit();
  CHECK(fs::file_size(folder.path / "a") == 1000 * 1001 + (1 << 20));
  AtomicFile named(folder.path / "b.step");
  put(named.path(), "by name");
  named.commit();
  CHECK(text_of(folder.path / "b.step") == "by name");
  CHECK(folder.entries() == 2);
}

TEST_CASE("atomic file: a link stays a link") {
  const Folder folder;
  fs::create_directory(folder.path / "elsewhere");
  put(folder.path / "elsewhere/real", "old");
  fs::create_symlink("elsewhere/real", folder.path / "link");
  AtomicFile file(folder.path / "link");
  file.stream() << "new";
  file.commit();
  CHECK(fs::is_symlink(folder.path / "link"));
  CHECK(text_of(folder.path / "elsewhere/real") == "new");
}

TEST_CASE("atomic file: places that cannot be written") {
  const Folder folder;
  put(folder.path / "file", "x");
  check_output_error([&] { AtomicFile f(folder.path); }, "Is a directory");
  check_output_error([&] { AtomicFile f(folder.path / "file/below"); }, "Not a directory");
  check_output_error([&] { AtomicFile f(folder.path / "missing/out"); }, "No such file");
  check_output_error([&] { AtomicFile f(folder.path / std::string(300, 'n')); }, "name too long");
  check_output_error([] { AtomicFile f(""); }, "cannot write");
  if (::getuid() != 0) {
    ::chmod((folder.path / "file").c_str(), 0444);
    check_output_error([&] { AtomicFile f(folder.path / "file"); }, "Permission denied");
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("atomic file: a full disk is an error, and devices are not replaced") {
  if (!fs::exists("/dev/full")) return;
  check_output_error(
      [] {
        AtomicFile file("/dev/full");
        file.stream() << "short";
        file.commit();
      },
      "/dev/full: cannot write: No space left");
  check_output_error(
      [] {
        AtomicFile file("/dev/full");
        for (int i = 0; i < 1000000; ++i) file.stream() << "more than the buffer holds ";
      },
      "No space left");
  CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("atomic folder: made with its parents, swapped, other files kept") {
  const Folder folder;
  const fs::path base = folder.path / "case";
  const std::vector<std::string> names{"points", "faces"};
  {
    AtomicFolder lost(base, "constant/polyMesh", names);
    *lost.create("points") << "1";
  }
  CHECK(folder.entries() == 0);
  const auto write = [&](const std::string& text) {
    AtomicFolder mesh(base, "constant/polyMesh", names);
    auto points = mesh.create("points");
    *points << text;
    points->close();
    mesh.commit();
  };
  write("first");
  const fs::path poly_mesh = base / "constant/polyMesh";
  CHECK(text_of(poly_mesh / "points") == "first");
  put(poly_mesh / "faces", "stale");
  put(poly_mesh / "blockMeshDict", "mine");
  fs::create_directories(base / "0");
  put(base / "0/U", "field");
  write("second");
  CHECK(text_of(poly_mesh / "points") == "second");
  CHECK_FALSE(fs::exists(poly_mesh / "faces"));
  CHECK(text_of(poly_mesh / "blockMeshDict") == "mine");
  CHECK(text_of(base / "0/U") == "field");
  CHECK(std::distance(fs::directory_iterator(base / "constant"), fs::directory_iterator()) == 1);
  {
    AtomicFolder lost(base / "", "constant/polyMesh", names);
    *lost.create("points") << "third";
  }
  CHECK(text_of(poly_mesh / "points") == "second");
  CHECK(std::distance(fs::directory_iterator(base / "constant"), fs::directory_iterator()) == 1);
}

TEST_CASE("atomic folder: places that cannot be written") {
  const Folder folder;
  put(folder.path / "file", "x");
  check_output_error([&] { AtomicFolder f(folder.path / "file", "polyMesh", {}); }, "Not a directory");
  check_output_error([&] { AtomicFolder f(folder.path / "file/case", "polyMesh", {}); }, "Not a directory");
  check_output_error([&] { AtomicFolder f(folder.path / "missing/case", "polyMesh", {}); }, "No such file");
  fs::create_directory(folder.path / "case");
  put(folder.path / "case/polyMesh", "a file");
  check_output_error([&] { AtomicFolder f(folder.path / "case", "polyMesh", {}); }, "Not a directory");
  CHECK(folder.entries() == 2);
}

TEST_CASE("unfinished outputs vanish when a program ends early") {
  const Folder folder;
  AtomicFile file(folder.path / "a");
  AtomicFolder mesh(folder.path / "case", "", {});
  *mesh.create("points") << "1";
  CHECK(folder.entries() == 2);
  remove_unfinished_outputs();
  CHECK(folder.entries() == 0);
}
