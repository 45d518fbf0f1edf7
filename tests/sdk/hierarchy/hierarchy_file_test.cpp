#include <filesystem>
#include <fstream>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <gtest/gtest.h>

#include "sdk/hierarchy/checksum.h"
#include "tests/sdk/hierarchy/shapes.h"

namespace armature::sdk {
namespace {

Hierarchy hierarchy_of(const Mesh& mesh) {
  auto build = build_hierarchy(mesh);
  EXPECT_TRUE(build);
  return build ? std::move(build->hierarchy) : Hierarchy();
}

std::string hex(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const char c : bytes) {
    text += kDigits[static_cast<unsigned char>(c) >> 4];
    text += kDigits[static_cast<unsigned char>(c) & 15];
  }
  return text;
}

/// With the checksum put right, so that what lies behind it is reached.
std::string sealed(std::string bytes) {
  const std::uint32_t sum = crc32(std::string_view(bytes).substr(24));
  for (std::size_t k = 0; k < 4; ++k) bytes[12 + k] = static_cast<char>(sum >> (8 * k));
  return bytes;
}

TEST(Crc32, IsThatOfGzip) {
  EXPECT_EQ(crc32("123456789"), 0xCBF4'3926U);
  EXPECT_EQ(crc32(""), 0U);
}

TEST(HierarchyFile, ReadsBackAsTheSame) {
  const HierarchyOptions pins{.pinned = {{VertexId(7)}, {VertexId(2), Sphere{{1, 2, 3}, 4}}}};
  for (const auto& [mesh, options] :
       {std::pair(ball(3), HierarchyOptions()), {two_balls(2), {}}, {soup(50), {}}, {ball(2), pins}}) {
    const auto hierarchy = build_hierarchy(mesh, options)->hierarchy;
    const auto bytes = encode_hierarchy(hierarchy);
    const auto again = parse_hierarchy(bytes, "test");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->parts().leaves, hierarchy.parts().leaves);
    EXPECT_EQ(again->parts().spheres, hierarchy.parts().spheres);
    EXPECT_EQ(again->parts().pinned, hierarchy.parts().pinned);
    EXPECT_EQ(again->parts().children, hierarchy.parts().children);
    EXPECT_EQ(again->parts().triangles, hierarchy.parts().triangles);
    EXPECT_EQ(again->parts().lasting, hierarchy.parts().lasting);
    EXPECT_EQ(again->parts().wire_edges, hierarchy.parts().wire_edges);
    EXPECT_EQ(again->parts().origin, hierarchy.parts().origin);
    EXPECT_EQ(again->parts().scale, hierarchy.parts().scale);
  }
}

TEST(HierarchyFile, HasTheseBytes) {
  Hierarchy::Parts parts;
  parts.origin = {1, 2, 3};
  parts.scale = 2;
  parts.leaves = {{0, 0, 0}, {0.5F, 0, 0}, {0, 0.5F, 0}};
  parts.spheres = {{0.25F, 0, 0, 0.125F}};
  parts.pinned = {{2, {0, 0.5F, 0, 1}}};
  parts.children = {{0, 1}};
  parts.triangles = {{0, 1, 2}};
  parts.lasting = {1, 0};
  parts.wire_edges = {{{0, 2}, 1, 2}};
  const auto hierarchy = Hierarchy::assemble(parts);
  ASSERT_TRUE(hierarchy) << hierarchy.error().message;
  const auto bytes = encode_hierarchy(*hierarchy);
  EXPECT_EQ(hex(bytes),
            "89534d480d0a1a0a"  // kind
            "02000000"
            "1ba076b9"          // version, checksum
            "8600000000000000"  // bytes that follow
            "03000000"
            "01000000"
            "01000000"
            "01000000"
            "01000000"  // vertices, collapses, triangles, wire edges, pinned vertices
            "000000000000f03f"
            "0000000000000040"
            "0000000000000840"
            "0000000000000040"  // origin, scale
            "000000000000000000000000"
            "0000003f0000000000000000"
            "000000000000003f00000000"                  // vertices
            "0000803e00000000000000000000003e"          // sphere
            "02000000000000000000003f000000000000803f"  // pinned vertex
            "0201"
            "01"
            "000202"
            "03040101");  // children, triangles that end, triangle, wire edge
  const auto mesh = parse_hierarchy(bytes, "test")->level(2);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->spheres[0].centre, Eigen::Vector3d(1.5, 2, 3));
  EXPECT_EQ(mesh->spheres[0].radius, 0.25);
  EXPECT_EQ(mesh->edges.size(), 1U);
}

TEST(HierarchyFile, RefusesEveryTruncatedPrefix) {
  const auto bytes = encode_hierarchy(hierarchy_of(ball(1)));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto result = parse_hierarchy(std::string_view(bytes).substr(0, size), "cut.smh");
    ASSERT_FALSE(result) << size;
    EXPECT_EQ(result.error().message.find("cut.smh: "), 0U);
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
  }
}

TEST(HierarchyFile, RefusesEveryFlippedBit) {
  const auto bytes = encode_hierarchy(hierarchy_of(ball(1)));
  for (std::size_t place = 0; place < bytes.size(); ++place) {
    auto altered = bytes;
    altered[place] = static_cast<char>(altered[place] ^ (1 << (place % 8)));
    EXPECT_FALSE(parse_hierarchy(altered, "altered.smh")) << place;
  }
}

TEST(HierarchyFile, RefusesPinsOutOfOrder) {
  const HierarchyOptions pins{.pinned = {{VertexId(7)}, {VertexId(2)}}};
  auto parts = build_hierarchy(ball(1), pins)->hierarchy.parts();
  EXPECT_TRUE(Hierarchy::assemble(parts));
  std::swap(parts.pinned[0], parts.pinned[1]);
  EXPECT_FALSE(Hierarchy::assemble(parts));
}

TEST(HierarchyFile, SurvivesWhatAnAuthorOfLiesWrites) {
  const auto hierarchy = hierarchy_of(soup(20));
  const auto bytes = encode_hierarchy(hierarchy);
  for (std::size_t place = 24; place < bytes.size(); ++place) {
    for (const int lie : {0x00, 0x7F, 0x80, 0xFF}) {
      auto altered = bytes;
      altered[place] = static_cast<char>(lie);
      const auto result = parse_hierarchy(sealed(altered), "lie.smh");
      if (!result) continue;
      for (std::size_t n = result->min_spheres(); n <= result->leaf_count(); n += 3) EXPECT_TRUE(result->level(n));
    }
  }
}

TEST(HierarchyFile, TakesNoMemoryForCountsThatDoNotFit) {
  auto bytes = encode_hierarchy(hierarchy_of(ball(1)));
  for (std::size_t k = 24; k < 44; ++k) bytes[k] = '\x7F';
  const auto result = parse_hierarchy(sealed(bytes), "huge.smh");
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("expected at least"), std::string::npos) << result.error().message;
}

TEST(HierarchyFile, RefusesAnotherVersion) {
  auto bytes = encode_hierarchy(hierarchy_of(ball(1)));
  bytes[8] = 1;
  EXPECT_EQ(parse_hierarchy(bytes, "old.smh").error().message, "old.smh: expected version 2, found 1");
}

TEST(HierarchyFile, IsWrittenAndRead) {
  const auto path = std::filesystem::path(testing::TempDir()) / "ball.smh";
  const auto hierarchy = hierarchy_of(ball(2));
  ASSERT_TRUE(write_hierarchy(hierarchy, path));
  const auto again = read_hierarchy(path);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->parts().spheres, hierarchy.parts().spheres);
  EXPECT_FALSE(read_hierarchy(path.string() + ".none"));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace armature::sdk
