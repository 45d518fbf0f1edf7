#include <cstdint>
#include <cstring>
#include <string>

#include <armature/sdk/io/read_mesh.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

std::string refusal(const std::string& bytes) {
  const auto mesh = parse_mesh(bytes, MeshFormat::Stl, "shape");
  return mesh ? "accepted" : mesh.error().message;
}

/// Two triangles that share an edge; one of its ends is written with a negative zero by one of them.
std::string binary_square() {
  std::string out = "solid that is binary";
  out.resize(80, '\0');
  const auto put = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint32_t{2});
  for (const auto& facet : {std::array<float, 9>{0, 0, 0, 1, 0, 0, 0, 1, 0}, {1, -0.0F, 0, 1, 1, 0, 0, 1, 0}}) {
    for (int i = 0; i < 3; ++i) put(0.0F);
    for (const float coordinate : facet) put(coordinate);
    put(std::uint16_t{0});
  }
  return out;
}

constexpr const char* kTriangle =
    "solid a triangle\n"
    " facet normal 0 0 nan\n"
    "  outer loop\n"
    "   vertex 0 0 0\n"
    "   vertex 1 0 0\n"
    "   vertex 0 1e-3 0\n"
    "  endloop\n"
    " ENDFACET\n"
    "endsolid a triangle\n";

TEST(Stl, WeldsEqualCornersOfABinaryFileThatBeginsWithSolid) {
  const auto mesh = parse_mesh(binary_square(), MeshFormat::Stl, "shape");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions.size(), 4U);
  ASSERT_EQ(mesh->triangles.size(), 2U);
  EXPECT_EQ(mesh->triangles[1], (Triangle{VertexId(1), VertexId(3), VertexId(2)}));
}

TEST(Stl, ReadsText) {
  const auto mesh = parse_mesh(kTriangle, MeshFormat::Stl, "shape");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions.at(2), Eigen::Vector3d(0, 1e-3, 0));
}

TEST(Stl, SaysWhereAndWhatWasExpected) {
  EXPECT_EQ(refusal(""), "shape, byte 0: expected 'solid' or a header of 84 bytes; the file ends here");
  EXPECT_EQ(refusal("solid nothing\nendsolid\n"), "shape: expected at least one face; it has none");
  EXPECT_EQ(refusal("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n"),
            "shape, line 4: expected a finite number; found 'inf'");
  EXPECT_EQ(refusal("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n"),
            "shape, line 5: expected vertex; found 'endloop'");
  EXPECT_EQ(refusal("solid\nfacet normal 0 0"), "shape, line 2: expected a finite number; the file ends here");
  EXPECT_EQ(refusal(binary_square() + "x").substr(0, 14), "shape, line 1:");
  std::string claims = binary_square();
  claims[0] = 'x';
  claims[83] = '\x7F';
  EXPECT_EQ(refusal(claims),
            "shape, byte 80: expected 106535321784 bytes for the 2130706434 facets announced; the file has 184");
  std::string infinite = binary_square();
  infinite[84 + 12 + 2] = '\x80';
  infinite[84 + 12 + 3] = '\x7F';
  EXPECT_EQ(refusal(infinite), "shape, byte 96: expected a finite coordinate");
}

TEST(Stl, EveryTruncatedPrefixIsRefused) {
  const std::string binary = binary_square();
  for (std::size_t length = 0; length < binary.size(); ++length)
    EXPECT_NE(refusal(binary.substr(0, length)), "accepted");
  const std::string text = kTriangle;
  const std::size_t last = text.find("endsolid") + 8;  // what follows is the name
  for (std::size_t length = 0; length < last; ++length) EXPECT_NE(refusal(text.substr(0, length)), "accepted");
}

}  // namespace
}  // namespace armature::sdk
