#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

const std::filesystem::path kModels = "../shared/data/meshes";

constexpr const char* kTetrahedronOff =
    "OFF\n"
    "# a tetrahedron\n"
    "4 4 6\n"
    "0 0 0\n"
    "1 0 0\n"
    "0 1 0\n"
    "0 0 1\n"
    "\n"
    "3 0 2 1\n"
    "3 0 1 3\n"
    "3 1 2 3\n"
    "3 0 3 2\n";

std::string message_of(const std::string& text, MeshFormat format) {
  const auto mesh = parse_mesh(text, format, "shape");
  return mesh ? "accepted" : mesh.error().message;
}

Mesh off(const std::string& text) {
  auto mesh = parse_mesh(text, MeshFormat::Off, "shape.off");
  EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
  return mesh.value_or(Mesh{});
}

Mesh obj(const std::string& text) {
  auto mesh = parse_mesh(text, MeshFormat::Obj, "shape.obj");
  EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
  return mesh.value_or(Mesh{});
}

/// Doubles of every magnitude, so that a digit lost anywhere shows.
Mesh awkward_mesh() {
  Mesh mesh;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-300, 300);
  for (int i = 0; i < 300; ++i)
    mesh.positions.emplace_back(mantissa(random), std::ldexp(mantissa(random), exponent(random)), i / 3.0);
  mesh.positions.emplace_back(-0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max());
  for (std::uint32_t i = 0; i + 2 < 301; ++i) {
    mesh.triangles.push_back({VertexId(i), VertexId(i + 1), VertexId(i + 2)});
    mesh.face_colours.push_back({static_cast<std::uint8_t>(i), 7, 255});
  }
  for (std::uint32_t i = 0; i < 301; ++i) mesh.vertex_colours.push_back({0, static_cast<std::uint8_t>(i), 128});
  return mesh;
}

void expect_same_bits(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (std::size_t i = 0; i < a.positions.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(a.positions[i][k], b.positions[i][k]) << i;
      ASSERT_EQ(std::signbit(a.positions[i][k]), std::signbit(b.positions[i][k])) << i;
    }
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.vertex_colours, b.vertex_colours);
}

TEST(Off, ReadsATetrahedron) {
  const Mesh mesh = off(kTetrahedronOff);
  ASSERT_EQ(mesh.positions.size(), 4U);
  ASSERT_EQ(mesh.triangles.size(), 4U);
  EXPECT_EQ(mesh.positions[3], Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(mesh.triangles[0], (Triangle{VertexId(0), VertexId(2), VertexId(1)}));
}

TEST(Off, ReadsCountsBehindTheKeywordAndLinesFromWindows) {
  const Mesh mesh = off("OFF 3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n");
  EXPECT_EQ(mesh.triangles.size(), 1U);
}

TEST(Off, ReadsColoursOfVerticesAndFacesWholeOrFractions) {
  const Mesh mesh = off("COFF\n3 1 0\n0 0 0 255 0 10 255\n1 0 0 0 1 2 255\n0 1 0 3 4 5 255\n3 0 1 2 1.0 0.5 0.0\n");
  ASSERT_EQ(mesh.vertex_colours.size(), 3U);
  EXPECT_EQ(mesh.vertex_colours[0], (Colour{255, 0, 10}));
  ASSERT_EQ(mesh.face_colours.size(), 1U);
  EXPECT_EQ(mesh.face_colours[0], (Colour{255, 128, 0}));
}

TEST(Off, GivesEveryTriangleOfAPolygonItsColour) {
  const Mesh mesh = off("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 9 8 7\n");
  ASSERT_EQ(mesh.triangles.size(), 2U);
  ASSERT_EQ(mesh.face_colours.size(), 2U);
  EXPECT_EQ(mesh.face_colours[1], (Colour{9, 8, 7}));
}

TEST(Off, SaysWhereAndWhatWasExpected) {
  EXPECT_EQ(message_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1.2.3 0\n3 0 1 2\n", MeshFormat::Off),
            "shape, line 5: expected a finite number; found '1.2.3'");
  EXPECT_EQ(message_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", MeshFormat::Off),
            "shape, line 5: expected a finite number; found 'nan'");
  EXPECT_EQ(message_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1e999 0\n3 0 1 2\n", MeshFormat::Off),
            "shape, line 5: expected a finite number; found '1e999'");
  EXPECT_EQ(message_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", MeshFormat::Off),
            "shape, line 6: expected the number of a vertex below 3; found '3'");
  EXPECT_EQ(message_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1\n", MeshFormat::Off),
            "shape, line 5: expected three coordinates; the line ends here");
  EXPECT_EQ(message_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", MeshFormat::Off),
            "shape, line 6: expected face 1 of 1; the file ends here");
  EXPECT_EQ(message_of("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", MeshFormat::Off),
            "shape: expected at least one face; it has none");
  EXPECT_EQ(message_of("", MeshFormat::Off), "shape, line 1: expected the keyword OFF; the file ends here");
  EXPECT_EQ(message_of("OFF BINARY\n", MeshFormat::Off), "shape, line 1: expected an ASCII file; found 'BINARY'");
}

TEST(Off, AHeaderThatClaimsBillionsOfElementsIsRefusedForWhatIsMissing) {
  EXPECT_EQ(message_of("OFF\n4294967294 4294967294 0\n0 0 0\n", MeshFormat::Off),
            "shape, line 4: expected vertex 2 of 4294967294; the file ends here");
  EXPECT_EQ(message_of("OFF\n4294967295 1 0\n0 0 0\n", MeshFormat::Off),
            "shape, line 2: expected the numbers of vertices, faces and edges; found '4294967295'");
}

TEST(Off, EveryTruncatedPrefixIsRefused) {
  const std::string whole = kTetrahedronOff;
  // All but the last newline: the last number may be told from a shorter one by nothing else.
  for (std::size_t length = 0; length + 1 < whole.size(); ++length)
    EXPECT_FALSE(parse_mesh(whole.substr(0, length), MeshFormat::Off, "shape")) << length;
}

TEST(Obj, CountsFromOneAndBackwards) {
  const Mesh mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2//2 3/3/3\nf -3 -2 -1\n");
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[0], mesh.triangles[1]);
}

TEST(Obj, SkipsWhatIsNoGeometryAndJoinsContinuedLines) {
  const Mesh mesh =
      obj("# made by hand\nmtllib none.mtl\no thing\ng a b\nusemtl x\ns off\nvt 0 0\nvn 0 0 nan\n"
          "v 0 0 \\\n 0\nv 1 0 0 1.0\nv 0 1 0\nl 1 2\nf 1 2 \\\r\n3");
  EXPECT_EQ(mesh.positions.size(), 3U);
  EXPECT_EQ(mesh.triangles.size(), 1U);
}

TEST(Obj, AFaceMayStandBeforeItsVertices) {
  EXPECT_EQ(obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").triangles.size(), 1U);
}

TEST(Obj, TriangulatesPolygons) {
  EXPECT_EQ(obj("v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\nv -1 1 0\nf 1 2 3 4 5\n").triangles.size(), 3U);
}

TEST(Obj, SaysWhereAndWhatWasExpected) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(message_of("v 1.2.3abc 0 0\n", MeshFormat::Obj),
            "shape, line 1: expected a finite number; found '1.2.3abc'");
  EXPECT_EQ(message_of("v 1e 0 0\n", MeshFormat::Obj), "shape, line 1: expected a finite number; found '1e'");
  EXPECT_EQ(message_of("v 1 inf 0\n", MeshFormat::Obj), "shape, line 1: expected a finite number; found 'inf'");
  EXPECT_EQ(message_of("v 1 2", MeshFormat::Obj), "shape, line 1: expected three coordinates; the file ends here");
  EXPECT_EQ(message_of(three + "f 1 2\n", MeshFormat::Obj),
            "shape, line 4: expected at least three corners of a face; the line ends here");
  EXPECT_EQ(message_of(three + "f 1 2 0\n", MeshFormat::Obj),
            "shape, line 4: expected the number of one of 3 vertices, from 1; found 0");
  EXPECT_EQ(message_of(three + "f 1 2 -4\n", MeshFormat::Obj),
            "shape, line 4: expected the number of one of 3 vertices, from 1; found -4");
  EXPECT_EQ(message_of(three + "f 1 2 4\nf 1 2 3\n", MeshFormat::Obj),
            "shape, line 4: expected the number of one of 3 vertices, from 1; found 4");
  EXPECT_EQ(message_of(three + "f 1 2 3x\n", MeshFormat::Obj),
            "shape, line 4: expected a corner such as 7, 7/1, 7//2 or 7/1/2; found '3x'");
  EXPECT_EQ(message_of(three + "0 1 2\n", MeshFormat::Obj),
            "shape, line 4: expected an OBJ statement such as v or f; found '0'");
  EXPECT_EQ(message_of(three, MeshFormat::Obj), "shape: expected at least one face; it has none");
}

TEST(Obj, ATruncatedPrefixIsRefusedUnlessItIsAShorterFile) {
  const std::string whole = "v 0.5 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nv 1 1 1 1\nf 1/1/1 2/2/2 3/3/3\nf 2//1 3//1 4//1\n";
  const std::size_t first_face = whole.find("3/3/3");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto mesh = parse_mesh(whole.substr(0, length), MeshFormat::Obj, "shape");
    if (!mesh) continue;
    EXPECT_GT(length, first_face);
    EXPECT_EQ(mesh->positions.size(), 4U);
  }
}

TEST(Obj, RefusesAPolygonOfMoreThanTenThousandCorners) {
  std::string text = "v 0 0 0\nf";
  for (int i = 0; i < 10'001; ++i) text += " 1";
  EXPECT_EQ(message_of(text, MeshFormat::Obj), "shape, line 2: expected a polygon of at most 10000 corners; found '1'");
}

TEST(MeshFiles, ObjAndOffReadBackTheSameBits) {
  const Mesh mesh = awkward_mesh();
  const auto as_obj = encode_mesh(mesh, MeshFormat::Obj);
  ASSERT_TRUE(as_obj);
  expect_same_bits(obj(*as_obj), mesh);
  const auto as_off = encode_mesh(mesh, MeshFormat::Off);
  ASSERT_TRUE(as_off);
  const Mesh again = off(*as_off);
  expect_same_bits(again, mesh);
  EXPECT_EQ(again.face_colours, mesh.face_colours);
}

TEST(MeshFiles, WritesTheBytesOfATriangle) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0.1, 0, 0}, {0, -2.5, 1e30}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}};
  EXPECT_EQ(encode_mesh(mesh, MeshFormat::Obj), "v 0 0 0\nv 0.1 0 0\nv 0 -2.5 1e+30\nf 1 2 3\n");
  EXPECT_EQ(encode_mesh(mesh, MeshFormat::Off), "OFF\n3 1 0\n0 0 0\n0.1 0 0\n0 -2.5 1e+30\n3 0 1 2\n");
  EXPECT_EQ(encode_mesh(mesh, MeshFormat::Ply, true),
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
            "element face 1\nproperty list uchar uint vertex_indices\nend_header\n"
            "0 0 0\n0.1 0 0\n0 -2.5 1e+30\n3 0 1 2\n");
}

TEST(MeshFiles, LeaveNothingBehindWhenTheyCannotBeWritten) {
  const auto folder = std::filesystem::temp_directory_path() / "armature_mesh_files_test";
  std::filesystem::create_directories(folder / "taken.obj");
  const auto written = write_mesh(awkward_mesh(), folder / "taken.obj");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("taken.obj: cannot be written"), std::string::npos);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

TEST(MeshFiles, AMissingFileIsNamed) {
  const auto mesh = read_mesh("nowhere.off");
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().message, "nowhere.off: cannot be read: No such file or directory");
  EXPECT_EQ(read_mesh("nowhere.gltf").error().message, "nowhere.gltf: cannot be read: No such file or directory");
  EXPECT_EQ(read_mesh(".", {.format = MeshFormat::Obj}).error().message, ".: cannot be read: Is a directory");
}

TEST(MeshFiles, StopWhenAsked) {
  std::string text = "OFF\n100000 1 0\n";
  for (int i = 0; i < 100'000; ++i) text += "0 0 0\n";
  text += "3 0 1 2\n";
  std::stop_source stop;
  double furthest = 0;
  const Task task{.stop = stop.get_token(), .progress = [&](std::string_view, double fraction) {
                    furthest = fraction;
                    if (fraction > 0.5) stop.request_stop();
                  }};
  const auto mesh = parse_mesh(text, MeshFormat::Off, "shape", task);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, ErrorKind::Cancelled);
  EXPECT_LT(furthest, 0.6);
}

TEST(MeshFiles, ReadAModelInItsOrder) {
  const auto path = kModels / "elephant_24955.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto mesh = read_mesh(path);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions.size(), 24955U);
  EXPECT_EQ(mesh->triangles.size(), 49918U);
}

}  // namespace
}  // namespace armature::sdk
