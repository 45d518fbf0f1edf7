#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <armature/sdk/io/sphere_mesh_file.h>
#include <armature/sdk/spheremesh/make_sphere_mesh.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_directory.h"

namespace armature::sdk {
namespace {

constexpr const char* kShape =
    "4 1 1\n"
    "v 0 0 0 1\n"
    "v 2 0 0 0.5\n"
    "v 0 2 0 0.25\n"
    "v 0 0 -3.5 0\n"
    "e 0 3\n"
    "f 0 1 2\n";

SphereMesh ma(const std::string& text) {
  auto shape = parse_sphere_mesh(text, SphereMeshFormat::Ma, "shape.ma");
  EXPECT_TRUE(shape) << (shape ? "" : shape.error().message);
  return shape.value_or(SphereMesh{});
}

std::string refusal(const std::string& text, SphereMeshFormat format = SphereMeshFormat::Ma) {
  const auto shape = parse_sphere_mesh(text, format, "shape");
  return shape ? "accepted" : shape.error().message;
}

SphereMesh awkward_shape() {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Sphere> spheres;
  for (int i = 0; i < 50; ++i)
    spheres.push_back({{number(random), number(random) * 1e-200, number(random) * 1e200}, std::abs(number(random))});
  std::vector<SpherePair> edges;
  std::vector<SphereTriple> triangles;
  for (int i = 0; i + 2 < 25; ++i) triangles.push_back({SphereId(i), SphereId(i + 1), SphereId(i + 2)});
  for (int i = 25; i + 1 < 50; ++i) edges.push_back({SphereId(i), SphereId(i + 1)});
  return make_sphere_mesh(spheres, edges, triangles);
}

void expect_same(const SphereMesh& a, const SphereMesh& b) {
  ASSERT_EQ(a.spheres.size(), b.spheres.size());
  for (std::size_t i = 0; i < a.spheres.size(); ++i) {
    EXPECT_EQ(a.spheres[i].centre, b.spheres[i].centre);
    EXPECT_EQ(a.spheres[i].radius, b.spheres[i].radius);
  }
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Ma, ReadsAndWritesTheSameBytes) {
  const SphereMesh shape = ma(kShape);
  ASSERT_EQ(shape.spheres.size(), 4U);
  EXPECT_EQ(shape.sphere(SphereId(1)).radius, 0.5);
  ASSERT_EQ(shape.edges.size(), 1U);
  EXPECT_EQ(shape.edges[0], (SpherePair{SphereId(0), SphereId(3)}));
  ASSERT_EQ(shape.triangles.size(), 1U);
  EXPECT_EQ(encode_sphere_mesh(shape, SphereMeshFormat::Ma), kShape);
}

TEST(Ma, SkipsCommentsAndBlankLines) {
  EXPECT_EQ(ma("# by hand\n\n1 0 0 # one\nv 1 2 3 4\n\n").spheres.size(), 1U);
}

TEST(Ma, ReadsFilesThatListTheEdgesOfTriangles) {
  const SphereMesh shape = ma("3 3 1\nv 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\ne 0 1\ne 1 2\ne 0 2\nf 2 1 0\n");
  EXPECT_TRUE(shape.edges.empty());
  EXPECT_EQ(shape.triangles.size(), 1U);
  EXPECT_EQ(encode_sphere_mesh(shape, SphereMeshFormat::Ma).substr(0, 6), "3 0 1\n");
}

TEST(Ma, SaysWhereAndWhatWasExpected) {
  EXPECT_EQ(refusal(""), "shape, line 1: expected the numbers of spheres, edges and triangles; the file ends here");
  EXPECT_EQ(refusal("1 0\n"),
            "shape, line 1: expected the numbers of spheres, edges and triangles; the line ends here");
  EXPECT_EQ(refusal("0 0 0\n"), "shape, line 1: expected at least one sphere; found '0'");
  EXPECT_EQ(refusal("1 0 0\nv 0 nan 0 1\n"), "shape, line 2: expected a finite number; found 'nan'");
  EXPECT_EQ(refusal("1 0 0\nv 0 0 0 -1\n"), "shape, line 2: expected a radius that is not negative; found '-1'");
  EXPECT_EQ(refusal("1 0 0\nv 0 0 0\n"), "shape, line 2: expected a finite number; the line ends here");
  EXPECT_EQ(refusal("1 0 0\nv 0 0 0 1 9\n"), "shape, line 2: expected the end of the line; found '9'");
  EXPECT_EQ(refusal("1 1 0\nv 0 0 0 1\ne 0 1\n"), "shape, line 3: expected the number of a sphere below 1; found '1'");
  EXPECT_EQ(refusal("1 0 1\nv 0 0 0 1\nf 0 0 -1\n"),
            "shape, line 3: expected the number of a sphere below 1; found '-1'");
  EXPECT_EQ(refusal("2 0 0\nv 0 0 0 1\n"), "shape, line 3: expected 2 lines v, found 1; the file ends here");
  EXPECT_EQ(refusal("1 0 0\nv 0 0 0 1\nv 0 0 0 1\n"), "shape, line 3: expected no more than 1 lines v; found 'v'");
  EXPECT_EQ(refusal("1 0 0\nx 0 0 0 1\n"), "shape, line 2: expected v, e or f; found 'x'");
  EXPECT_EQ(refusal("4294967294 0 0\nv 0 0 0 1\n"),
            "shape, line 3: expected 4294967294 lines v, found 1; the file ends here");
}

TEST(Ma, EveryTruncatedPrefixIsRefused) {
  const std::string whole = kShape;
  for (std::size_t length = 0; length + 1 < whole.size(); ++length)
    EXPECT_NE(refusal(whole.substr(0, length)), "accepted") << length;
}

TEST(SphereMeshFile, IsToldFromAMeshByItsNameAndItsHeader) {
  const test::TemporaryDirectory directory;
  const auto holds = [&](const char* name, const std::string& bytes) {
    std::ofstream(directory / name, std::ios::binary) << bytes;
    return holds_sphere_mesh(directory / name);
  };
  EXPECT_TRUE(holds("a.MA", ""));
  EXPECT_FALSE(holds("a.off", ""));
  EXPECT_TRUE(holds("a.ply", encode_sphere_mesh(awkward_shape(), SphereMeshFormat::Ply)));
  const std::string vertices = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string ends = "end_header\n0 0 0 1\n";
  EXPECT_FALSE(holds("a.ply", "ply\nformat ascii 1.0\n" + vertices + ends));
  EXPECT_TRUE(holds("a.ply", "ply\nformat ascii 1.0\n" + vertices + "property float radius\n" + ends));
  EXPECT_FALSE(holds("a.ply", "ply\n"));
  EXPECT_FALSE(holds_sphere_mesh(directory / "missing.ply"));
}

TEST(SpherePly, HoldsTheSameBitsAndEveryTruncatedPrefixIsRefused) {
  const SphereMesh shape = awkward_shape();
  const std::string bytes = encode_sphere_mesh(shape, SphereMeshFormat::Ply);
  const auto again = parse_sphere_mesh(bytes, SphereMeshFormat::Ply, "shape.ply");
  ASSERT_TRUE(again) << again.error().message;
  expect_same(*again, shape);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    ASSERT_NE(refusal(bytes.substr(0, length), SphereMeshFormat::Ply), "accepted") << length;
}

TEST(SpherePly, ReadsWhatOtherProgramsWrite) {
  const auto shape = parse_sphere_mesh(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float quality\nproperty float radius\nelement face 1\nproperty list uchar int "
      "vertex_index\nend_header\n"
      "0 0 0 7 1\n1 0 0 7 2\n0 1 0 7 3\n3 0 1 2\n",
      SphereMeshFormat::Ply, "shape.ply");
  ASSERT_TRUE(shape) << shape.error().message;
  EXPECT_EQ(shape->spheres[2].radius, 3);
  EXPECT_EQ(shape->triangles.size(), 1U);
}

TEST(SpherePly, NormalsAndAreasOfSpheresAreNobodysBusiness) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float area\nproperty float radius\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
      "0 0 0 0 0 0 -1 1\n3 0 0 0 nan 0 nan 2\n0 1\n";
  const auto shape = parse_sphere_mesh(text, SphereMeshFormat::Ply, "shape.ply");
  ASSERT_TRUE(shape) << shape.error().message;
  EXPECT_EQ(shape->spheres[1].radius, 2);
  EXPECT_EQ(shape->edges.size(), 1U);
}

TEST(SpherePly, RefusesWhatIsNoSphereMesh) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_EQ(refusal(header + "end_header\n0 0 0\n", SphereMeshFormat::Ply),
            "shape: expected a property radius of element vertex");
  EXPECT_EQ(refusal(header + "property float radius\nend_header\n0 0 0 -2\n", SphereMeshFormat::Ply),
            "shape, line 9: expected a radius that is finite and not negative; found '-2'");
  EXPECT_EQ(refusal("", SphereMeshFormat::Urdf), "shape: expected a sphere-mesh as .ma or .ply; URDF is written only");
}

TEST(SphereMeshFiles, ComeBackFromDiskAsTheyWere) {
  const SphereMesh shape = awkward_shape();
  const auto folder = std::filesystem::temp_directory_path() / "armature_sphere_mesh_files_test";
  std::filesystem::create_directories(folder);
  for (const char* name : {"shape.ma", "shape.PLY"}) {
    ASSERT_TRUE(write_sphere_mesh(shape, folder / name));
    const auto again = read_sphere_mesh(folder / name);
    ASSERT_TRUE(again) << again.error().message;
    expect_same(*again, shape);
  }
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(write_sphere_mesh(shape, folder / "shape.txt"));
}

TEST(Urdf, HoldsEverySphereWithARadiusAsCollisionAndVisual) {
  EXPECT_EQ(
      encode_sphere_mesh(ma("2 0 0\nv 1 2 3 0.5\nv 0 0 0 0\n"), SphereMeshFormat::Urdf, "a<b"),
      "<?xml version=\"1.0\"?>\n"
      "<robot name=\"a&lt;b\">\n"
      "  <link name=\"a&lt;b\">\n"
      "    <collision><origin xyz=\"1 2 3\" rpy=\"0 0 0\"/><geometry><sphere radius=\"0.5\"/></geometry></collision>\n"
      "    <visual><origin xyz=\"1 2 3\" rpy=\"0 0 0\"/><geometry><sphere radius=\"0.5\"/></geometry></visual>\n"
      "  </link>\n"
      "</robot>\n");
}

}  // namespace
}  // namespace armature::sdk
