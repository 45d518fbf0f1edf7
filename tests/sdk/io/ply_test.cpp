#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

std::string refusal(const std::string& bytes) {
  const auto mesh = parse_mesh(bytes, MeshFormat::Ply, "shape");
  return mesh ? "accepted" : mesh.error().message;
}

template <class Number>
void put(std::string& out, Number number, bool big) {
  std::array<char, sizeof(Number)> bytes{};
  std::memcpy(bytes.data(), &number, bytes.size());
  if (big) std::reverse(bytes.begin(), bytes.end());
  out.append(bytes.data(), bytes.size());
}

/// Three vertices and a face in every type that PLY has, in either byte order.
std::string every_type(bool big) {
  std::string out = "ply\nformat ";
  out += big ? "binary_big_endian" : "binary_little_endian";
  out +=
      " 1.0\ncomment every type\nobj_info and more\nelement camera 1\nproperty list ushort int16 rows\n"
      "element vertex 3\nproperty char a\nproperty ushort b\nproperty float x\nproperty double y\nproperty int16 z\n"
      "property uint8 red\nproperty uint8 green\nproperty uint8 blue\nproperty list uchar double c\n"
      "element face 1\nproperty uint flags\nproperty list int uint32 vertex_indices\nproperty float red\n"
      "property float green\nproperty float blue\nend_header\n";
  put<std::uint16_t>(out, 2, big);
  put<std::int16_t>(out, -5, big);
  put<std::int16_t>(out, 5, big);
  for (int i = 0; i < 3; ++i) {
    put<std::int8_t>(out, -1, big);
    put<std::uint16_t>(out, 60000, big);
    put<float>(out, 0.1F * static_cast<float>(i), big);
    put<double>(out, 0.3 * i * i, big);
    put<std::int16_t>(out, static_cast<std::int16_t>(-300 * i), big);
    for (int k = 0; k < 3; ++k) put<std::uint8_t>(out, static_cast<std::uint8_t>(100 * i + k), big);
    put<std::uint8_t>(out, static_cast<std::uint8_t>(i), big);
    for (int k = 0; k < i; ++k) put<double>(out, 1, big);
  }
  put<std::uint32_t>(out, 0xFFFFFFFF, big);
  put<std::int32_t>(out, 3, big);
  for (const std::uint32_t corner : {2U, 0U, 1U}) put(out, corner, big);
  for (const float channel : {1.0F, 0.5F, 0.0F}) put(out, channel, big);
  return out;
}

TEST(Ply, ReadsEveryTypeInEitherByteOrder) {
  for (const bool big : {false, true}) {
    const auto mesh = parse_mesh(every_type(big), MeshFormat::Ply, "shape");
    ASSERT_TRUE(mesh) << mesh.error().message;
    ASSERT_EQ(mesh->positions.size(), 3U);
    EXPECT_EQ(mesh->positions[2], Eigen::Vector3d(0.1F * 2, 0.3 * 2 * 2, -600));
    EXPECT_EQ(mesh->triangles.at(0), (Triangle{VertexId(2), VertexId(0), VertexId(1)}));
    EXPECT_EQ(mesh->vertex_colours.at(2), (Colour{200, 201, 202}));
    EXPECT_EQ(mesh->face_colours.at(0), (Colour{255, 128, 0}));
  }
}

TEST(Ply, EveryTruncatedPrefixIsRefused) {
  for (const bool big : {false, true}) {
    const std::string whole = every_type(big);
    for (std::size_t length = 0; length < whole.size(); ++length)
      ASSERT_NE(refusal(whole.substr(0, length)), "accepted") << length;
  }
}

TEST(Ply, EveryTruncatedPrefixOfATextIsRefused) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}};
  const std::string whole = encode_mesh(mesh, MeshFormat::Ply, true).value();
  for (std::size_t length = 0; length + 1 < whole.size(); ++length)
    ASSERT_NE(refusal(whole.substr(0, length)), "accepted") << length;
}

TEST(Ply, ReadsTextWithLinesFromWindows) {
  EXPECT_EQ(refusal("ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\n"
                    "property float z\r\nelement face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n"
                    "0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n"),
            "accepted");
}

TEST(Ply, WhatIsWrittenReadsBackInTextAndBinary) {
  Mesh mesh;
  mesh.positions = {{0.1, 1e-310, -7}, {1.0 / 3, 2, 1e300}, {3, 4, -0.0}, {1, 1, 1}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(3), VertexId(1), VertexId(2)}};
  for (const bool coloured : {false, true}) {
    if (coloured) {
      mesh.vertex_colours = {{1, 2, 3}, {0, 255, 128}, {9, 9, 9}, {4, 4, 4}};
      mesh.face_colours = {{7, 8, 9}, {200, 100, 50}};
    }
    for (const bool ascii : {false, true}) {
      const auto bytes = encode_mesh(mesh, MeshFormat::Ply, ascii);
      ASSERT_TRUE(bytes);
      const auto again = parse_mesh(*bytes, MeshFormat::Ply, "shape");
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(again->positions, mesh.positions);
      EXPECT_EQ(again->triangles, mesh.triangles);
      EXPECT_EQ(again->vertex_colours, mesh.vertex_colours);
      EXPECT_EQ(again->face_colours, mesh.face_colours);
    }
  }
}

TEST(Ply, ReadsColoursInAnyUnit) {
  const auto mesh = parse_mesh(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property ushort diffuse_red\nproperty ushort diffuse_green\nproperty ushort diffuse_blue\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0 65535 0 257\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n",
      MeshFormat::Ply, "shape");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->vertex_colours.at(0), (Colour{255, 0, 1}));
}

TEST(Ply, SaysWhereAndWhatWasExpected) {
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(refusal(""), "shape, line 1: expected the keyword ply; the file ends here");
  EXPECT_EQ(refusal("ply\nformat text 1.0\n"),
            "shape, line 2: expected ascii, binary_little_endian or binary_big_endian; found 'text'");
  EXPECT_EQ(refusal(head + "element vertex many\n"),
            "shape, line 3: expected a number of elements below 4294967295; found 'many'");
  EXPECT_EQ(refusal(head + "property float x\n"),
            "shape, line 3: expected an element before its properties; found 'property'");
  EXPECT_EQ(refusal(head + "element vertex 1\nproperty real x\n"),
            "shape, line 4: expected a type such as float or uchar; found 'real'");
  EXPECT_EQ(refusal(head + "element vertex 1\nend_header\n"),
            "shape, line 4: expected a property of element vertex; found 'end_header'");
  EXPECT_EQ(refusal(head + vertices + "end_header\n" + three), "shape: expected at least one face; it has none");
  EXPECT_EQ(refusal(head + vertices + faces + "0 0 0\n1 0 0\n0 1e\n3 0 1 2\n"),
            "shape, line 12: expected a number of vertex 3 of 3; found '1e'");
  EXPECT_EQ(refusal(head + vertices + faces + "0 0 0\n1 0 0\n0 -inf 0\n3 0 1 2\n"),
            "shape, line 12: expected finite coordinates; found '-inf'");
  EXPECT_EQ(refusal(head + vertices + faces + three + "3 0 1 3\n"),
            "shape, line 13: expected the number of a vertex below 3; found '3'");
  EXPECT_EQ(refusal(head + vertices + faces + three + "3 0 1 0.5\n"),
            "shape, line 13: expected the number of a vertex below 3; found '0.500000'");
  EXPECT_EQ(refusal(head + vertices + faces + three + "2 0 1\n"),
            "shape, line 13: expected a face of 3 to 10000 corners; found '2'");
  EXPECT_EQ(refusal(head + vertices + faces + three + "3 0 1 2 x\n"),
            "shape, line 13: expected a number of face 1 of 1; found 'x'");
  EXPECT_EQ(refusal(head + vertices + faces + three + "3 0 1 2\n5\n"),
            "shape, line 14: expected nothing behind the last element; found '5'");
}

TEST(Ply, ReadsLinesThatHoldMoreThanTheHeaderSaysButNotTheirColours) {
  const auto mesh = parse_mesh(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 1 1 1 1 1\n",
      MeshFormat::Ply, "shape");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 1U);
  EXPECT_TRUE(mesh->face_colours.empty());
}

TEST(Ply, RadiiAndEdgesOfMeshesAreNobodysBusiness) {
  EXPECT_EQ(refusal("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "property float radius\nelement face 1\nproperty list uchar int vertex_indices\n"
                    "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
                    "0 0 0 -1\n1 0 0 nan\n0 1 0 1\n3 0 1 2\n0 7\n"),
            "accepted");
}

TEST(Ply, TriangleStripsAreRefusedNotDropped) {
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n";
  const std::string strips = "property list int int vertex_indices\nend_header\n";
  const std::string three = "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n";
  const auto with = [&](const std::string& bytes) {
    const auto shape = parse_mesh_or_points(bytes, MeshFormat::Ply, "shape");
    return shape ? "accepted" : shape.error().message;
  };
  EXPECT_EQ(with(vertices + "element tristrips 1\n" + strips + three + "4 0 1 2 -1\n"),
            "shape: holds triangle strips; convert them to faces");
  EXPECT_EQ(with(vertices + "element tristrips 0\n" + strips + three), "accepted");
}

TEST(Ply, AHeaderThatClaimsBillionsOfElementsIsRefusedAtOnce) {
  for (const char* encoding : {"ascii", "binary_little_endian"}) {
    const std::string text = std::string("ply\nformat ") + encoding +
                             " 1.0\nelement vertex 4294967294\nproperty float x\nproperty float y\nproperty float z\n"
                             "end_header\n0 0 0\n";
    EXPECT_NE(refusal(text).find("expected 4294967294 elements 'vertex'"), std::string::npos) << refusal(text);
  }
}

TEST(Ply, AListThatClaimsBillionsOfCornersIsRefused) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\n"
      "element face 1\nproperty list uint uint vertex_indices\nend_header\n";
  bytes.append(3, '\0');
  put<std::uint32_t>(bytes, 0xFFFFFFFF, false);
  EXPECT_NE(refusal(bytes).find("expected face 1 of 1; the file ends here"), std::string::npos) << refusal(bytes);
}

}  // namespace
}  // namespace armature::sdk
