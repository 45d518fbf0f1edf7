#include <filesystem>
#include <fstream>
#include <string>

#include <armature/sdk/io/read_mesh.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

/// An AC3D file: a square of one polygon, moved by (0, 0, 5), beside a line that is no surface.
constexpr const char* kSquare =
    "AC3Db\n"
    "MATERIAL \"\" rgb 1 1 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\n"
    "OBJECT world\nkids 1\n"
    "OBJECT poly\nname \"square\"\nloc 0 0 5\nnumvert 4\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n"
    "numsurf 1\nSURF 0x10\nmat 0\nrefs 4\n0 0 0\n1 0 0\n2 0 0\n3 0 0\nkids 0\n";

TEST(Assimp, ReadsOtherFormatsWithPolygonsCutAndPartsInTheirPlace) {
  const auto mesh = parse_mesh(kSquare, MeshFormat::Other, "square.ac");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions.size(), 4U);
  EXPECT_EQ(mesh->triangles.size(), 2U);
  for (const Eigen::Vector3d& p : mesh->positions) EXPECT_EQ(p.z(), 5);
}

TEST(Assimp, ReadsAFile) {
  const auto path = std::filesystem::temp_directory_path() / "armature_assimp_test.ac";
  std::ofstream(path) << kSquare;
  const auto mesh = read_mesh(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 2U);
}

TEST(Assimp, SaysWhatItDoesNotRead) {
  const auto mesh = parse_mesh("no mesh at all", MeshFormat::Other, "letter.txt");
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().message,
            "letter.txt: expected OFF, OBJ, PLY, STL, XYZ, glTF, FBX, Collada or what else assimp reads; found `.txt`");
  EXPECT_FALSE(parse_mesh("", MeshFormat::Other, "empty.gltf"));
}

TEST(Assimp, EveryTruncatedPrefixIsRefusedOrReadAndNoneEndsTheProgram) {
  const std::string whole = kSquare;
  for (std::size_t length = 0; length < whole.size(); length += 29)
    (void)parse_mesh(whole.substr(0, length), MeshFormat::Other, "square.ac");
}

TEST(Assimp, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const auto mesh = parse_mesh(kSquare, MeshFormat::Other, "square.ac", {.stop = stop.get_token()});
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace armature::sdk
