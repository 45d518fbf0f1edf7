#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <armature/sdk/mesh/mesh.h>

/// Small meshes whose properties are known.
namespace armature::sdk::surfaces {

/// Corners by plain numbers.
inline Triangle triangle(std::size_t a, std::size_t b, std::size_t c) {
  return {VertexId(a), VertexId(b), VertexId(c)};
}

/// A mesh by plain numbers.
inline Mesh mesh_of(std::vector<Eigen::Vector3d> positions, const std::vector<std::array<int, 3>>& faces) {
  Mesh mesh{.positions = std::move(positions)};
  for (const auto& [a, b, c] : faces) mesh.triangles.push_back({VertexId(a), VertexId(b), VertexId(c)});
  return mesh;
}

/// A surface over a grid of rows and columns; either may wrap around. `at` takes fractions of [0, 1].
struct Grid {
  int rows = 20;
  int columns = 20;
  bool wraps_rows = false;
  bool wraps_columns = false;
  double jitter = 0;  ///< of a cell
};

inline Mesh over(const Grid& grid, const std::function<Eigen::Vector3d(double, double)>& at) {
  Mesh mesh;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> shift(-grid.jitter, grid.jitter);
  const int rows = grid.wraps_rows ? grid.rows : grid.rows + 1;
  const int columns = grid.wraps_columns ? grid.columns : grid.columns + 1;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double di = shift(random);
      const double dj = shift(random);
      mesh.positions.push_back(at((i + di) / grid.rows, (j + dj) / grid.columns));
    }
  const auto id = [&](int i, int j) { return static_cast<std::size_t>(i % rows * columns + j % columns); };
  for (int i = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j) {
      mesh.triangles.push_back(triangle(id(i, j), id(i + 1, j), id(i + 1, j + 1)));
      mesh.triangles.push_back(triangle(id(i, j), id(i + 1, j + 1), id(i, j + 1)));
    }
  return mesh;
}

/// Around the z axis, normals outward.
inline Mesh torus(double large, double small, int rows = 60, int columns = 30, double jitter = 0) {
  return over({rows, columns, true, true, jitter}, [=](double i, double j) {
    const double u = 2 * std::numbers::pi * i;
    const double v = 2 * std::numbers::pi * j;
    const double r = large + small * std::cos(v);
    return Eigen::Vector3d(r * std::cos(u), r * std::sin(u), small * std::sin(v));
  });
}

/// Around the z axis, open at both ends, normals outward.
inline Mesh cylinder(double radius, double height, int around = 60, int along = 30, double jitter = 0) {
  return over({around, along, true, false, jitter}, [=](double i, double j) {
    const double u = 2 * std::numbers::pi * i;
    return Eigen::Vector3d(radius * std::cos(u), radius * std::sin(u), height * j);
  });
}

/// z = (a x^2 + c y^2) / 2 over [-1, 1]^2, normals up.
inline Mesh paraboloid(double a, double c, int cells = 40, double jitter = 0) {
  return over({cells, cells, false, false, jitter}, [=](double i, double j) {
    const double x = 2 * i - 1;
    const double y = 2 * j - 1;
    return Eigen::Vector3d(x, y, 0.5 * (a * x * x + c * y * y));
  });
}

/// A sphere whose vertices are those of an icosahedron split `rounds` times, normals outward.
inline Mesh icosphere(int rounds, double radius = 1) {
  const double g = std::numbers::phi;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  constexpr std::array<std::array<std::size_t, 3>, 20> kFaces = {
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (const auto& [a, b, c] : kFaces) mesh.triangles.push_back(triangle(a, b, c));
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<VertexId, VertexId>, VertexId> middles;
    const auto middle = [&](VertexId a, VertexId b) {
      const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), VertexId(mesh.positions.size()));
      if (is_new) mesh.positions.emplace_back(0.5 * (mesh.position(a) + mesh.position(b)));
      return found->second;
    };
    std::vector<Triangle> split;
    for (const auto& [a, b, c] : mesh.triangles) {
      const VertexId ab = middle(a, b);
      const VertexId bc = middle(b, c);
      const VertexId ca = middle(c, a);
      split.insert(split.end(), {Triangle{a, ab, ca}, Triangle{b, bc, ab}, Triangle{c, ca, bc}, Triangle{ab, bc, ca}});
    }
    mesh.triangles = std::move(split);
  }
  for (Eigen::Vector3d& p : mesh.positions) p = radius * p.normalized();
  return mesh;
}

/// The corners (0 or 1, 0 or 1, 0 or 1), normals outward.
inline Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  constexpr std::array<std::array<std::size_t, 4>, 6> kSides = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : kSides) {
    mesh.triangles.push_back(triangle(a, b, c));
    mesh.triangles.push_back(triangle(a, c, d));
  }
  return mesh;
}

/// Both meshes beside one another.
inline Mesh together(Mesh a, const Mesh& b) {
  const std::size_t offset = a.positions.size();
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& [i, j, k] : b.triangles)
    a.triangles.push_back(triangle(i.index() + offset, j.index() + offset, k.index() + offset));
  return a;
}

inline Mesh inside_out(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

inline Mesh moved(Mesh mesh, const Eigen::Vector3d& by, double scale = 1) {
  for (Eigen::Vector3d& p : mesh.positions) p = scale * p + by;
  return mesh;
}

}  // namespace armature::sdk::surfaces
