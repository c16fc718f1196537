#include "tests/subdivide/cage_zoo.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace flowcage::zoo {
namespace {

using Faces = std::vector<std::vector<Index>>;
using std::numbers::pi;

Faces faces_of(const Cage& cage) {
  Faces faces;
  for (Index f = 0; f < cage.faces.size(); ++f)
    faces.emplace_back(cage.faces[f].begin(), cage.faces[f].end());
  return faces;
}
void set_faces(Cage& cage, const Faces& faces) {
  cage.faces = {};
  for (const auto& face : faces) cage.faces.push_row(face);
  cage.face_patch.assign(faces.size(), 0);
}

// The face on the left of each directed side.
std::map<std::pair<Index, Index>, std::size_t> sides_of(const Faces& faces) {
  std::map<std::pair<Index, Index>, std::size_t> sides;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t i = 0; i < faces[f].size(); ++i) {
      sides[{faces[f][i], faces[f][(i + 1) % faces[f].size()]}] = f;
    }
  }
  return sides;
}

void split_by_diagonal(Faces& faces, std::size_t f, Random& random) {
  const auto face = faces[f];
  const auto n = static_cast<int>(face.size());
  if (n < 4) return;
  const int i = random.below(n), j = (i + 2 + random.below(n - 3)) % n;
  const auto sides = sides_of(faces);
  if (sides.contains({face[i], face[j]}) || sides.contains({face[j], face[i]})) return;
  std::vector<Index> one, two;
  for (int k = i; k != j; k = (k + 1) % n) one.push_back(face[k]);
  one.push_back(face[j]);
  for (int k = j; k != i; k = (k + 1) % n) two.push_back(face[k]);
  two.push_back(face[i]);
  faces[f] = one;
  faces.push_back(two);
}

void split_by_centre(Cage& cage, Faces& faces, std::size_t f) {
  const auto face = faces[f];
  Vec3 centre = Vec3::Zero();
  for (const Index v : face) centre += cage.points[v] / static_cast<double>(face.size());
  const auto c = static_cast<Index>(cage.points.size());
  cage.points.push_back(centre);
  for (std::size_t i = 0; i < face.size(); ++i) {
    const std::vector<Index> part{face[i], face[(i + 1) % face.size()], c};
    if (i == 0) {
      faces[f] = part;
    } else {
      faces.push_back(part);
    }
  }
}

void merge_across(Faces& faces, std::size_t f, Random& random) {
  const auto face = faces[f];
  const auto n = face.size();
  const auto sides = sides_of(faces);
  const auto i = static_cast<std::size_t>(random.below(static_cast<int>(n)));
  const Index a = face[i], b = face[(i + 1) % n];
  const auto other = sides.find({b, a});
  if (other == sides.end()) return;
  const auto valence = [&](Index v) {
    return std::count_if(sides.begin(), sides.end(), [&](const auto& side) { return side.first.first == v; });
  };
  if (valence(a) < 4 || valence(b) < 4) return;
  std::vector<Index> merged;
  for (std::size_t k = 1; k < n; ++k) merged.push_back(face[(i + k) % n]);  // b .. before a
  const auto& second = faces[other->second];
  const auto m = second.size();
  const auto at = static_cast<std::size_t>(std::find(second.begin(), second.end(), a) - second.begin());
  for (std::size_t k = 0; k + 1 < m; ++k) merged.push_back(second[(at + k) % m]);  // a .. before b
  auto sorted = merged;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return;
  faces[f] = merged;
  faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(other->second));
}

}  // namespace

std::uint64_t Random::bits() {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}
double Random::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
}
int Random::below(int n) {
  return n <= 1 ? 0 : static_cast<int>(bits() % static_cast<std::uint64_t>(n));
}

Cage make_cage(std::vector<Vec3> points, const std::vector<std::vector<Index>>& faces) {
  Cage cage;
  cage.points = std::move(points);
  set_faces(cage, faces);
  cage.patch_names = {""};
  return cage;
}

Cage cube() {
  return voxels({{0, 0, 0}});
}

Cage tetrahedron() {
  return make_cage({{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}},
                   {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

Cage prism(int n) {
  std::vector<Vec3> points;
  Faces faces(2);
  for (int i = 0; i < n; ++i) {
    const double a = 2 * pi * i / n;
    points.emplace_back(std::cos(a), std::sin(a), -1);
    points.emplace_back(std::cos(a), std::sin(a), 1);
    faces[0].push_back(2 * (n - 1 - i));
    faces[1].push_back(2 * i + 1);
    const Index j = 2 * ((i + 1) % n);
    faces.push_back({2 * i, j, j + 1, 2 * i + 1});
  }
  return make_cage(points, faces);
}

Cage pyramid(int n) {
  std::vector<Vec3> points{{0, 0, 1}};
  Faces faces(1);
  for (int i = 0; i < n; ++i) {
    points.emplace_back(std::cos(2 * pi * i / n), std::sin(2 * pi * i / n), 0);
    faces[0].push_back(n - i);
    faces.push_back({0, i + 1, (i + 1) % n + 1});
  }
  return make_cage(points, faces);
}

Cage double_pyramid(int n) {
  Cage cage = pyramid(n);
  Faces faces = faces_of(cage);
  faces.erase(faces.begin());
  cage.points.emplace_back(0, 0, -1);
  for (int i = 0; i < n; ++i) faces.push_back({n + 1, (i + 1) % n + 1, i + 1});
  return make_cage(cage.points, faces);
}

Cage torus(int around, int across) {
  std::vector<Vec3> points;
  Faces faces;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2 * pi * i / around, b = 2 * pi * j / across, r = 3 + std::cos(b);
      points.emplace_back(r * std::cos(a), r * std::sin(a), std::sin(b));
      const int i1 = (i + 1) % around, j1 = (j + 1) % across;
      faces.push_back({i * across + j, i1 * across + j, i1 * across + j1, i * across + j1});
    }
  }
  return make_cage(points, faces);
}

Cage grid(int nx, int ny) {
  std::vector<Vec3> points;
  Faces faces;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) points.emplace_back(i, j, 0.3 * std::sin(1.3 * i + 0.7 * j));
  }
  const auto at = [nx](int i, int j) { return j * (nx + 1) + i; };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return make_cage(points, faces);
}

Cage fan(int n, bool closed) {
  std::vector<Vec3> points{{0, 0, 0}};
  Faces faces;
  const int ring = closed ? 2 * n : 2 * n + 1;
  for (int i = 0; i < ring; ++i) {
    const double a = (closed ? 2 : 1) * pi * i / (2 * n), r = i % 2 == 0 ? 1 : 1.3;
    points.emplace_back(r * std::cos(a), r * std::sin(a), 0.1 * std::cos(3 * a));
  }
  for (int i = 0; i < n; ++i) faces.push_back({0, 2 * i + 1, 2 * i + 2, (2 * i + 2) % ring + 1});
  return make_cage(points, faces);
}

Cage voxels(const std::set<std::array<int, 3>>& cells) {
  std::map<std::array<int, 3>, Index> number;
  std::vector<Vec3> points;
  Faces faces;
  const auto corner = [&](const std::array<int, 3>& at) {
    const auto [place, is_new] = number.try_emplace(at, static_cast<Index>(points.size()));
    if (is_new) points.emplace_back(at[0], at[1], at[2]);
    return place->second;
  };
  for (const auto& cell : cells) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        auto neighbour = cell;
        neighbour[axis] += step;
        if (cells.contains(neighbour)) continue;
        const int u = (axis + 1) % 3, w = (axis + 2) % 3;
        std::vector<Index> face;
        for (const auto& [du, dw] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
          auto at = cell;
          at[axis] += step > 0 ? 1 : 0;
          at[u] += step > 0 ? du : dw;
          at[w] += step > 0 ? dw : du;
          face.push_back(corner(at));
        }
        faces.push_back(face);
      }
    }
  }
  return make_cage(points, faces);
}

Cage pillow() {
  // A quad prism squeezed: vertices 4 and 5 have two faces each.
  return make_cage({{0, 0, 0}, {2, 0, 0.1}, {2, 2, 0}, {0, 2, -0.1}, {1, 1, 1}, {1, 1, -1}},
                   {{0, 1, 2, 4}, {0, 4, 2, 3}, {0, 5, 2, 1}, {0, 3, 2, 5}});
}

void scramble(Cage& cage, Random& random, int steps) {
  Faces faces = faces_of(cage);
  for (int k = 0; k < steps; ++k) {
    const auto f = static_cast<std::size_t>(random.below(static_cast<int>(faces.size())));
    switch (random.below(5)) {
      case 0:
        split_by_centre(cage, faces, f);
        break;
      case 1:
      case 2:
        split_by_diagonal(faces, f, random);
        break;
      default:
        merge_across(faces, f, random);
    }
  }
  set_faces(cage, faces);
}

void perturb(Cage& cage, Random& random, double amount) {
  for (Vec3& p : cage.points) {
    for (int d = 0; d < 3; ++d) p[d] += random.uniform(-amount, amount);
  }
}

void add_tags(Cage& cage, Random& random, Tags tags, double share) {
  if (tags == Tags::none) return;
  const auto sharpness = [&] {
    Tags kind = tags;
    if (kind == Tags::mixed) kind = random.below(2) == 0 ? Tags::infinite : Tags::semi_sharp;
    if (kind == Tags::infinite) return infinitely_sharp;
    if (kind == Tags::whole) return 1.0 + random.below(3);
    return random.below(3) + (1 + random.below(9)) * (105.0 / 1024);
  };
  for (const auto& [side, face] : sides_of(faces_of(cage))) {
    if (side.first < side.second && random.uniform(0, 1) < share) {
      cage.creases.push_back({side.first, side.second, sharpness()});
    }
  }
  for (Index v = 0; v < static_cast<Index>(cage.points.size()); ++v) {
    if (random.uniform(0, 1) < share / 2) cage.corners.push_back({v, sharpness()});
  }
}

std::vector<NamedCage> all() {
  std::vector<NamedCage> cages;
  const auto add = [&](std::string name, Cage cage) { cages.push_back({std::move(name), std::move(cage)}); };
  add("cube", cube());
  add("tetrahedron", tetrahedron());
  for (const int n : {3, 5, 6, 8}) add("prism " + std::to_string(n), prism(n));
  for (const int n : {3, 5, 7, 12}) add("pyramid " + std::to_string(n), pyramid(n));
  for (const int n : {4, 6, 9}) add("double pyramid " + std::to_string(n), double_pyramid(n));
  add("torus 4x3", torus(4, 3));
  add("torus 7x5", torus(7, 5));
  for (const int n : {2, 3, 5, 6, 9}) {
    if (n > 2) add("closed fan " + std::to_string(n), fan(n, true));
    add("open fan " + std::to_string(n), fan(n, false));
  }
  add("pillow", pillow());
  add("grid 1x1", grid(1, 1));
  add("grid 3x4", grid(3, 4));
  std::set<std::array<int, 3>> ring, eight, branched;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i < 3 && !(i == 1 && j == 1)) ring.insert({i, j, 0});
      if (!(j == 1 && i % 2 == 1)) eight.insert({i, j, 0});
    }
  }
  for (int i = -1; i <= 1; ++i) branched.insert({{i, 0, 0}, {0, i, 0}, {0, 0, i}});
  add("genus 1", voxels(ring));
  add("genus 2", voxels(eight));
  add("branched", voxels(branched));

  Random random(20260101);
  const Tags kinds[] = {Tags::none, Tags::infinite, Tags::semi_sharp, Tags::whole, Tags::mixed};
  for (int k = 0; k < 35; ++k) {
    Cage cage;
    switch (k / 5) {
      case 0:
        cage = grid(4, 3);
        break;
      case 1:
        cage = torus(6, 4);
        break;
      case 2:
        cage = voxels(eight);
        break;
      case 3:
        cage = prism(7);
        break;
      case 4:
        cage = voxels(branched);
        break;
      case 5:
        cage = cube();
        break;
      default:
        cage = grid(2, 5);
    }
    scramble(cage, random, 25);
    perturb(cage, random, 0.1);
    add_tags(cage, random, kinds[k % 5], k / 5 % 2 == 0 ? 0.12 : 0.3);
    add("random " + std::to_string(k), cage);
  }
  return cages;
}

}  // namespace flowcage::zoo
