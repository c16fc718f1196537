#include "tests/export/sample_meshes.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

namespace flowcage::tests {
namespace {

// The 24 rotations of a hex's corner numbers, made from two generators.
std::vector<std::array<int, 8>> rotations() {
  const std::array<int, 8> about_k{1, 2, 3, 0, 5, 6, 7, 4}, about_diagonal{0, 3, 7, 4, 1, 2, 6, 5};
  std::vector<std::array<int, 8>> group{{0, 1, 2, 3, 4, 5, 6, 7}};
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (const auto& g : {about_k, about_diagonal}) {
      std::array<int, 8> next{};
      for (int c = 0; c < 8; ++c) next[c] = group[i][g[c]];
      if (std::find(group.begin(), group.end(), next) == group.end()) group.push_back(next);
    }
  }
  return group;
}

}  // namespace

HexMesh box_mesh(const std::array<Index, 3>& n, const std::function<Vec3(const Vec3&)>& map) {
  const auto number = [&](Index i, Index j, Index k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
  std::vector<Vec3> points;
  for (Index k = 0; k <= n[2]; ++k) {
    for (Index j = 0; j <= n[1]; ++j) {
      for (Index i = 0; i <= n[0]; ++i) {
        points.push_back(map({double(i) / n[0], double(j) / n[1], double(k) / n[2]}));
      }
    }
  }
  std::vector<BoundaryPatch> patches{{"wall", PatchType::wall, {}, {}},
                                     {"symmetry plane", PatchType::symmetry, {}, {}},
                                     {"inlet", PatchType::inlet, {}, {}},
                                     {"outlet", PatchType::outlet, {}, {}},
                                     {"far", PatchType::farfield, {}, {}}};
  constexpr std::array<int, 6> patch_of_face{0, 2, 4, 3, 1, 4};
  std::vector<HexPoints> cells;
  for (Index k = 0; k < n[2]; ++k) {
    for (Index j = 0; j < n[1]; ++j) {
      for (Index i = 0; i < n[0]; ++i) {
        const HexPoints cell{number(i, j, k),
                             number(i + 1, j, k),
                             number(i + 1, j + 1, k),
                             number(i, j + 1, k),
                             number(i, j, k + 1),
                             number(i + 1, j, k + 1),
                             number(i + 1, j + 1, k + 1),
                             number(i, j + 1, k + 1)};
        const std::array<bool, 6> outer{i == 0, i == n[0] - 1, j == 0, j == n[1] - 1, k == 0, k == n[2] - 1};
        for (int f = 0; f < 6; ++f) {
          if (!outer[f]) continue;
          BoundaryPatch& patch = patches[patch_of_face[f]];
          const auto& c = hex_faces[f];
          patch.quads.push_back({cell[c[0]], cell[c[1]], cell[c[2]], cell[c[3]]});
          patch.owner.push_back(static_cast<Index>(cells.size()));
        }
        cells.push_back(cell);
      }
    }
  }
  return {std::move(points), std::move(cells), std::move(patches)};
}

HexMesh box_mesh(const std::array<Index, 3>& n) {
  return box_mesh(n, [](const Vec3& p) { return p; });
}

HexMesh perturbed_box(const std::array<Index, 3>& n, double amount) {
  std::mt19937 random(12345);
  std::uniform_real_distribution<double> move(-amount, amount);
  return box_mesh(n, [&](const Vec3& p) {
    const bool inner = p.minCoeff() > 0 && p.maxCoeff() < 1;
    return inner ? Vec3(p + Vec3(move(random), move(random), move(random))) : p;
  });
}

HexMesh sphere_shell(Index n, Index layers, double outer, bool half) {
  // The cube's surface as a lattice of (n+1)^3; a face's (a, b) steps are right-handed with its normal.
  std::map<std::array<Index, 3>, Index> lattice;
  std::vector<std::array<std::array<Index, 3>, 4>> quads;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      for (Index a = 0; a < n; ++a) {
        for (Index b = 0; b < n; ++b) {
          std::array<std::array<Index, 3>, 4> quad{};
          const std::array<std::array<Index, 2>, 4> steps{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
          Index low = n;
          for (int c = 0; c < 4; ++c) {
            quad[c][axis] = side * n;
            quad[c][(axis + 1) % 3] = a + steps[c][0];
            quad[c][(axis + 2) % 3] = b + steps[c][1];
            low = std::min(low, quad[c][2]);
          }
          if (half && (2 * low < n || (axis == 2 && side == 0))) continue;
          if (side == 0) std::swap(quad[1], quad[3]);
          for (const auto& corner : quad) lattice.emplace(corner, static_cast<Index>(lattice.size()));
          quads.push_back(quad);
        }
      }
    }
  }
  const Index surface = static_cast<Index>(lattice.size());
  std::vector<Vec3> points(static_cast<std::size_t>(surface) * (layers + 1));
  for (const auto& [corner, v] : lattice) {
    Vec3 p;
    for (int d = 0; d < 3; ++d) p[d] = std::tan((double(corner[d]) / n - 0.5) * std::numbers::pi / 2);
    if (2 * corner[2] == n) p.z() = 0;
    p.normalize();
    for (Index layer = 0; layer <= layers; ++layer) {
      points[layer * surface + v] = p * std::pow(outer, double(layer) / layers);
    }
  }
  std::vector<BoundaryPatch> patches{{"sphere", PatchType::wall, {}, {}},
                                     {"farfield", PatchType::farfield, {}, {}}};
  if (half) patches.push_back({"symmetry", PatchType::symmetry, {}, {}});
  std::vector<HexPoints> cells;
  for (Index layer = 0; layer < layers; ++layer) {
    for (const auto& quad : quads) {
      HexPoints cell{};
      for (int c = 0; c < 4; ++c) {
        cell[c] = layer * surface + lattice.at(quad[c]);
        cell[c + 4] = cell[c] + surface;
      }
      for (int f = 0; f < 6; ++f) {
        const auto& c = hex_faces[f];
        const std::array<Index, 4> face{cell[c[0]], cell[c[1]], cell[c[2]], cell[c[3]]};
        const bool flat = std::all_of(face.begin(), face.end(), [&](Index p) { return points[p].z() == 0; });
        const int patch = f == 4 && layer == 0            ? 0
                          : f == 5 && layer == layers - 1 ? 1
                          : half && f < 4 && flat         ? 2
                                                          : -1;
        if (patch < 0) continue;
        patches[patch].quads.push_back(face);
        patches[patch].owner.push_back(static_cast<Index>(cells.size()));
      }
      cells.push_back(cell);
    }
  }
  return {std::move(points), std::move(cells), std::move(patches)};
}

HexMesh shuffled(const HexMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  const auto new_numbers = [&](std::size_t count) {
    std::vector<Index> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0);
    std::shuffle(numbers.begin(), numbers.end(), random);
    return numbers;
  };
  const auto new_point = new_numbers(mesh.points().size());
  const auto new_cell = new_numbers(static_cast<std::size_t>(mesh.cell_count()));
  const auto turns = rotations();
  std::vector<Vec3> points(new_point.size());
  for (std::size_t p = 0; p < points.size(); ++p) points[new_point[p]] = mesh.points()[p];
  std::vector<HexPoints> old(new_cell.size()), cells(new_cell.size());
  mesh.read_cells(0, old);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto& turn = turns[random() % turns.size()];
    for (int i = 0; i < 8; ++i) cells[new_cell[c]][i] = new_point[old[c][turn[i]]];
  }
  std::vector<BoundaryPatch> patches = mesh.patches();
  for (BoundaryPatch& patch : patches) {
    for (auto& quad : patch.quads) {
      for (Index& p : quad) p = new_point[p];
      std::rotate(quad.begin(), quad.begin() + random() % 4, quad.end());
    }
    for (Index& c : patch.owner) c = new_cell[c];
  }
  return {std::move(points), std::move(cells), std::move(patches)};
}

double enclosed_volume(const HexView& mesh) {
  double six_volumes = 0;
  const auto p = mesh.points();
  for (const BoundaryPatch& patch : mesh.patches()) {
    for (const auto& q : patch.quads) {
      const Vec3 middle = (p[q[0]] + p[q[1]] + p[q[2]] + p[q[3]]) / 4;
      for (int i = 0; i < 4; ++i) six_volumes += middle.dot(p[q[i]].cross(p[q[(i + 1) % 4]]));
    }
  }
  return six_volumes / 6;
}

}  // namespace flowcage::tests
