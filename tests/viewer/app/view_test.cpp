// What the window's view shows of sphere-meshes and meshes, held against exact rays. Skipped where OpenGL is not
// available.
#include <atomic>
#include <cmath>
#include <random>

#include <armature/sdk/spheremesh/extract.h>
#include <backends/imgui_impl_opengl3.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include "viewer/app/app.h"
#include "viewer/app/view_painter.h"
#include "viewer/render/gl_context.h"

namespace armature::viewer {
namespace {

using Eigen::Vector3d;
using sdk::SphereId;
using sdk::VertexId;

constexpr int kWidth = 480, kHeight = 320;
constexpr double kAspect = 1.5;

struct Stage {
  std::unique_ptr<GlContext> context;
  std::optional<ViewPainter> painter;
};

/// One for all tests.
Stage* stage() {
  static Stage stage = [] {
    Stage made;
    if (auto context = GlContext::create()) {
      made.context = std::move(*context);
      made.painter.emplace(std::move(*ViewPainter::create()));
    }
    return made;
  }();
  return stage.context ? &stage : nullptr;
}

class TheView : public ::testing::Test {
 protected:
  void SetUp() override {
    if (stage() == nullptr) GTEST_SKIP() << "no OpenGL here";
    session.aspect = kAspect;
  }
  Image painted() {
    const auto done = stage()->painter->paint(session, kWidth, kHeight, true);
    EXPECT_TRUE(done) << done.error().message;
    glBindFramebuffer(GL_FRAMEBUFFER, stage()->painter->picture().framebuffer());
    auto image = read_picture(kWidth, kHeight);
    EXPECT_TRUE(image) << image.error().message;  // no OpenGL error, too
    return *image;
  }
  /// The line of sight through a place of the picture, in pixels from its upper left corner.
  [[nodiscard]] sdk::Ray ray(double x, double y) const {
    return session.camera.ray({(2 * x / kWidth - 1) * kAspect, 1 - 2 * y / kHeight});
  }
  Session session;
};

sdk::Colour at(const Image& image, int x, int y) {
  const std::size_t first = 3 * static_cast<std::size_t>(y * image.width + x);
  return {image.rgb[first], image.rgb[first + 1], image.rgb[first + 2]};
}

int difference(const sdk::Colour& a, const sdk::Colour& b) {
  int most = 0;
  for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(int{a[k]} - int{b[k]}));
  return most;
}

/// Spheres of many sizes, edges and triangles between them, some of which cross.
sdk::SphereMesh tangle(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) { return low + (high - low) * (random() / 4294967296.0); };
  sdk::SphereMesh shape;
  for (int i = 0; i < 14; ++i)
    shape.spheres.push_back({{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, uniform(0.02, 0.3)});
  for (std::size_t i = 0; i + 1 < 6; ++i) shape.edges.push_back({SphereId(i), SphereId(i + 1)});
  for (std::size_t i = 6; i + 2 < 14; ++i) shape.triangles.push_back({SphereId(i), SphereId(i + 1), SphereId(i + 2)});
  return shape;
}

std::shared_ptr<Model> model_of(sdk::SphereMesh shape) {
  auto model = std::make_shared<Model>();
  model->name = "shape";
  model->set_spheres(std::move(shape));
  return model;
}

TEST_F(TheView, ShowsTheExactSilhouetteOfASphereMesh) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    session.models.clear();
    session.add(model_of(tangle(seed)));
    ASSERT_TRUE(session.execute("spheres surface"));
    const Image image = painted();
    ASSERT_TRUE(session.execute("spheres off"));
    const Image empty = painted();
    const sdk::SphereMeshTree tree(*session.models.front()->spheres->shape);
    int both = 0, either = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool seen = difference(at(image, x, y), at(empty, x, y)) > 2;
        bool covered = false;  // at one of the pixel's nine samples
        for (const double dy : {1 / 6.0, 3 / 6.0, 5 / 6.0})
          for (const double dx : {1 / 6.0, 3 / 6.0, 5 / 6.0})
            covered = covered || tree.intersect(ray(x + dx, y + dy)).has_value();
        both += seen && covered ? 1 : 0;
        either += seen || covered ? 1 : 0;
      }
    }
    ASSERT_GT(both, 5000);
    EXPECT_GE(static_cast<double>(both) / either, 0.99) << "intersection over union, seed " << seed;
    RecordProperty("iou", std::to_string(static_cast<double>(both) / either));
  }
}

/// A square wall at x + z = 0, green, through the middle of the tangle.
sdk::Mesh wall() {
  sdk::Mesh mesh;
  mesh.positions = {{-1.2, -1.2, 1.2}, {1.2, -1.2, -1.2}, {1.2, 1.2, -1.2}, {-1.2, 1.2, 1.2}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(0), VertexId(2), VertexId(3)}};
  mesh.face_colours.assign(2, {0, 160, 0});
  return mesh;
}

TEST_F(TheView, ShowsSphereMeshesAndMeshesInTheOrderOfTheirDepths) {
  auto model = model_of(tangle(4));
  model->mesh = std::make_shared<const MeshShape>(wall());
  session.add(model);
  ASSERT_TRUE(session.execute("camera 90 10"));
  const Image image = painted();
  int wrong = 0, of_wall = 0, of_spheres = 0;
  for (int y = 1; y + 1 < kHeight; ++y) {
    for (int x = 1; x + 1 < kWidth; ++x) {
      // Where all corners of the pixel agree there is no doubt about it.
      int walls = 0, spheres = 0;
      for (const double dy : {0.0, 1.0}) {
        for (const double dx : {0.0, 1.0}) {
          const auto found = session.pick({(2 * (x + dx) / kWidth - 1) * kAspect, 1 - 2 * (y + dy) / kHeight});
          walls += found && found->face.valid() ? 1 : 0;
          spheres += found && found->sphere.valid() ? 1 : 0;
        }
      }
      if (walls != 4 && spheres != 4) continue;
      const sdk::Colour colour = at(image, x, y);
      // The wall is seen from either side; its back has a colour without green.
      const bool green = colour[1] > colour[0] + 15 && colour[1] > colour[2] + 15;
      const bool purple = colour[0] > colour[1] + 8 && colour[2] > colour[1] + 8;
      wrong += (walls == 4) != (green || purple) ? 1 : 0;
      of_wall += walls == 4 ? 1 : 0;
      of_spheres += spheres == 4 ? 1 : 0;
    }
  }
  EXPECT_GT(of_wall, 2000);
  EXPECT_GT(of_spheres, 2000);
  EXPECT_LT(wrong, (of_wall + of_spheres) / 200) << "of " << of_wall + of_spheres << " pixels";
}

TEST_F(TheView, ShowsOtherColoursAsIfTheMeshWereNew) {
  auto model = std::make_shared<Model>();
  model->mesh = std::make_shared<const MeshShape>(wall());
  session.add(model);
  ASSERT_TRUE(session.execute("camera 60 10"));
  const Image plain = painted();
  model->selecting.selection.combine({sdk::FaceId(1)}, sdk::Combine::Replace);
  ++model->colour_revision;
  const Image selected = painted();
  EXPECT_NE(selected.rgb, plain.rgb);
  stage()->painter.emplace(std::move(*ViewPainter::create()));
  EXPECT_EQ(painted().rgb, selected.rgb);
}

TEST_F(TheView, IsPaintedAgainOnlyWhereItChanged) {
  session.add(model_of(tangle(5)));
  const Image first = painted();
  const std::size_t before = stage()->painter->painted();
  EXPECT_EQ(painted().rgb, first.rgb);
  EXPECT_EQ(stage()->painter->painted(), before) << "nothing has changed";
  ASSERT_TRUE(session.execute("camera 40 20"));
  EXPECT_NE(painted().rgb, first.rgb);
  EXPECT_EQ(stage()->painter->painted(), before + 1);
}

/// Where any picture takes too long and any shape is large: it is drawn coarser while it moves, and alike.
void expect_coarser_only_while_it_moves(Session& session, std::shared_ptr<Model> model) {
  auto painter = ViewPainter::create({.fluent_ms = -1, .slow_ms = 1e9, .most_fluent_faces = 0, .coarse_cells = 12});
  ASSERT_TRUE(painter) << painter.error().message;
  session.add(std::move(model));
  const auto picture = [&](bool careful) {
    const auto done = painter->paint(session, kWidth, kHeight, careful);
    EXPECT_TRUE(done) << done.error().message;
    glBindFramebuffer(GL_FRAMEBUFFER, painter->picture().framebuffer());
    auto image = read_picture(kWidth, kHeight);
    EXPECT_TRUE(image) << image.error().message;
    return *image;
  };
  picture(true);
  ASSERT_TRUE(session.execute("camera 30 20"));
  const Image moving = picture(false);
  EXPECT_TRUE(painter->rough());
  for (int bits = 0; painter->rough() && bits < 1000; ++bits) picture(false);
  const Image standing = picture(false);
  EXPECT_FALSE(painter->rough());
  EXPECT_EQ(standing.rgb, picture(false).rgb);
  int differ = 0, covered = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      differ += difference(at(moving, x, y), at(standing, x, y)) > 24 ? 1 : 0;
      covered += session.pick({(2 * (x + 0.5) / kWidth - 1) * kAspect, 1 - 2 * (y + 0.5) / kHeight}) ? 1 : 0;
    }
  }
  EXPECT_GT(differ, 0) << "the coarse one was not drawn";
  EXPECT_LT(differ, covered / 5) << "of " << covered << " pixels";
}

sdk::Mesh ball_of_40_cells() {
  sdk::SphereMesh ball;
  ball.spheres = {{{0, 0, 0}, 1}};
  return sdk::extract_surface(ball, {.tolerance = 1e-3}, {}).value();
}

TEST_F(TheView, ShowsALargeMeshCoarserOnlyWhileItMoves) {
  auto model = std::make_shared<Model>();
  model->mesh = std::make_shared<const MeshShape>(ball_of_40_cells());
  expect_coarser_only_while_it_moves(session, model);
}

TEST_F(TheView, ShowsALargeSphereMeshCoarserOnlyWhileItMoves) {
  const sdk::Mesh mesh = ball_of_40_cells();
  sdk::SphereMesh shell;
  for (const Eigen::Vector3d& position : mesh.positions) shell.spheres.push_back({position, 0.01});
  for (const auto& [a, b, c] : mesh.triangles)
    shell.triangles.push_back({sdk::SphereId(a.index()), sdk::SphereId(b.index()), sdk::SphereId(c.index())});
  auto model = std::make_shared<Model>();
  model->set_spheres(std::move(shell));
  expect_coarser_only_while_it_moves(session, model);
}

TEST_F(TheView, IsTheSameWhereItsDrawingsAreMadeInTheBackground) {
  auto large = ViewPainter::create({.most_fluent_faces = 0});
  auto small = ViewPainter::create({.most_fluent_faces = 1000});
  ASSERT_TRUE(large && small);
  auto model = std::make_shared<Model>();
  model->mesh = std::make_shared<const MeshShape>(wall());
  session.add(model);
  ASSERT_TRUE(session.execute("camera 60 10"));
  const auto settled = [&](ViewPainter& painter) {
    do {
      const auto done = painter.paint(session, kWidth, kHeight, false);
      EXPECT_TRUE(done) << done.error().message;
    } while (painter.rough());
    glBindFramebuffer(GL_FRAMEBUFFER, painter.picture().framebuffer());
    return read_picture(kWidth, kHeight).value().rgb;
  };
  const auto plain = settled(*large);
  EXPECT_EQ(plain, settled(*small));
  model->selecting.selection.combine({sdk::FaceId(1)}, sdk::Combine::Replace);
  ++model->colour_revision;
  const auto selected = settled(*large);
  EXPECT_NE(selected, plain);
  EXPECT_EQ(selected, settled(*small));
  // Another model, and back: nothing of the one before is left.
  auto other = std::make_shared<Model>();
  sdk::Mesh half = wall();
  half.triangles.resize(1);
  half.face_colours.resize(1);
  other->mesh = std::make_shared<const MeshShape>(std::move(half));
  session.models.push_back(other);
  session.active_model = 1;
  static_cast<void>(large->paint(session, kWidth, kHeight, false));  // is being made
  session.active_model = 0;
  EXPECT_EQ(settled(*large), selected);
  session.active_model = 1;
  EXPECT_EQ(settled(*large), settled(*small));
}

TEST_F(TheView, LetsGoOfAModelThatIsClosed) {
  const Image empty = painted();
  auto model = model_of(tangle(5));
  model->mesh = std::make_shared<const MeshShape>(wall());
  const std::weak_ptr<const Model> closed = model;
  session.add(std::move(model));
  EXPECT_NE(painted().rgb, empty.rgb);
  session.models.clear();
  EXPECT_TRUE(closed.expired()) << "what is drawn of it does not hold it";
  session.camera = {};
  EXPECT_EQ(painted().rgb, empty.rgb);
}

TEST_F(TheView, HasFewerPixelsOnlyWhileItMovesWhereThatIsSlow) {
  // Any picture is slow.
  auto painter = ViewPainter::create({.fluent_ms = -1, .slow_ms = -1});
  ASSERT_TRUE(painter) << painter.error().message;
  session.add(model_of(tangle(6)));
  const auto paint = [&] {
    const auto done = painter->paint(session, kWidth, kHeight, false);
    EXPECT_TRUE(done) << done.error().message;
  };
  paint();
  EXPECT_EQ(painter->picture().width(), kWidth) << "nobody knows yet";
  ASSERT_TRUE(session.execute("camera 30 20"));
  paint();
  EXPECT_EQ(painter->picture().width(), kWidth / 2);
  for (int bits = 0; painter->rough() && bits < 1000; ++bits) paint();
  EXPECT_FALSE(painter->rough());
  EXPECT_EQ(painter->picture().width(), kWidth);
}

TEST_F(TheView, IsPaintedWithMoreCareForAPicture) {
  session.add(model_of(tangle(7)));
  auto window = ViewPainter::create({.fluent_ms = 1e9}), fresh = ViewPainter::create();
  ASSERT_TRUE(window && fresh);
  const auto picture = [&](ViewPainter& painter, bool careful) {
    const auto done = painter.paint(session, kWidth, kHeight, careful);
    EXPECT_TRUE(done) << done.error().message;
    glBindFramebuffer(GL_FRAMEBUFFER, painter.picture().framebuffer());
    return read_picture(kWidth, kHeight).value().rgb;
  };
  const auto standing = picture(*window, false);
  EXPECT_FALSE(window->rough());
  const auto careful = picture(*window, true);
  EXPECT_NE(careful, standing);
  EXPECT_EQ(careful, picture(*fresh, true));
  EXPECT_EQ(careful, picture(*window, false)) << "it need not be painted again";
}

TEST_F(TheView, LetsWorkBeCancelledInTheSmallestWindow) {
  session.add(model_of(tangle(1)));
  ImGui::CreateContext();
  {
    const auto app = App::create(session, 1);
    ASSERT_TRUE(app) << app.error().message;
    std::atomic<bool> done = false;
    session.start("reading", [&](const sdk::Task&) -> sdk::Expected<Job::Apply> {
      done.wait(false);
      return Job::Apply();
    });
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {200, 150};
    io.DeltaTime = 0.02F;
    static_cast<void>(painted());  // makes the framebuffer
    for (const bool down : {false, false, true, false}) {
      io.MousePos = {40, 132};
      io.MouseDown[ImGuiMouseButton_Left] = down;
      ImGui_ImplOpenGL3_NewFrame();
      const auto drawn = (*app)->draw(200, 150, stage()->painter->picture().framebuffer(), false);
      EXPECT_TRUE(drawn) << drawn.error().message;
    }
    EXPECT_TRUE(session.job.stopping());
    EXPECT_NEAR(session.aspect, 200.0 / 150, 1e-6) << "the view keeps its size";
    done = true;
    done.notify_all();
    while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  }
  ImGui::DestroyContext();
}

TEST_F(TheView, OfTwoModelsBearsThatTheSidebarTakesOneAway) {
  session.add(model_of(tangle(1)));
  session.add(model_of(tangle(2)));
  ASSERT_TRUE(session.execute("beside 1"));
  ImGui::CreateContext();
  {
    const auto app = App::create(session, 1);
    ASSERT_TRUE(app) << app.error().message;
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {800, 480};
    io.DeltaTime = 0.02F;
    const auto draw = [&] {
      ImGui_ImplOpenGL3_NewFrame();
      const auto drawn = (*app)->draw(800, 480, stage()->painter->picture().framebuffer(), false);
      EXPECT_TRUE(drawn) << drawn.error().message;
    };
    static_cast<void>(painted());  // makes the framebuffer
    // Down along the sidebar, below the buttons that open dialogs, until something was hit that ends it.
    for (float y = 80; y < 200 && session.other() != nullptr; y += 6) {
      io.MousePos = {24, y};
      draw();
      for (const bool down : {true, false}) {
        io.MouseDown[ImGuiMouseButton_Left] = down;
        draw();
      }
      ASSERT_TRUE(session.execute("mode shapes"));
    }
    EXPECT_EQ(session.other(), nullptr) << "nothing was hit";
    draw();
  }
  ImGui::DestroyContext();
}

}  // namespace
}  // namespace armature::viewer
