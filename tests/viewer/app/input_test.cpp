// What the mouse and the keys do in the view, without a window: ImGui is told where they are.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include <gtest/gtest.h>

#include "tests/viewer/app/hands.h"
#include "viewer/session/posing.h"
#include "viewer/session/script.h"

namespace armature::viewer {
namespace {

using Eigen::Vector3d;

TEST_F(Hands, TurnTheModelWithTheToolForLooking) {
  const Eigen::Matrix4d before = camera();
  drag({300, 200}, {60, 20});
  EXPECT_FALSE(camera().isApprox(before));
  EXPECT_EQ(selected(), 0U);
}

TEST_F(Hands, SelectWithAToolAndNeverMoveTheCameraByAccident) {
  for (const char* tool : {"click", "brush", "lasso"}) {
    ASSERT_TRUE(session.execute(std::string("tool ") + tool));
    ASSERT_TRUE(session.execute("clear"));
    const Eigen::Matrix4d before = camera();
    const double distance = session.camera.distance;
    if (std::string(tool) == "lasso") {
      frame({250, 150});
      ImGui::GetIO().MouseDown[0] = true;
      for (const ImVec2 at : {ImVec2{250, 150}, ImVec2{350, 150}, ImVec2{350, 250}, ImVec2{250, 250}}) frame(at);
      ImGui::GetIO().MouseDown[0] = false;
      frame({250, 250});
    } else {
      drag({300, 200}, {40, 10});
    }
    ImGui::GetIO().MouseWheel = 2;
    frame({300, 200});
    ImGui::GetIO().MouseWheel = 0;
    drag({300, 200}, {40, 40}, 1);
    drag({5, 5}, {60, 0});  // beside the model
    EXPECT_TRUE(camera().isApprox(before, 1e-6)) << tool;
    EXPECT_NEAR(session.camera.distance, distance, 1e-6 * distance) << tool;
    EXPECT_GT(selected(), 10U) << tool;
  }
}

TEST_F(Hands, MoveTheCameraWithAltWhateverTheTool) {
  for (const char* tool : {"click", "cut", "brush", "lasso", "edge", "pose", "spot"}) {
    ASSERT_TRUE(session.execute(std::string("tool ") + tool));
    Eigen::Matrix4d before = camera();
    ImGui::GetIO().KeyAlt = true;
    drag({300, 200}, {60, 20});
    EXPECT_FALSE(camera().isApprox(before)) << tool << ", turned";
    before = camera();
    drag({300, 200}, {60, 20}, 1);
    EXPECT_FALSE(camera().isApprox(before)) << tool << ", moved";
    const double distance = session.camera.distance;
    ImGui::GetIO().MouseWheel = 1;
    frame({300, 200});
    ImGui::GetIO().MouseWheel = 0;
    EXPECT_LT(session.camera.distance, distance) << tool << ", zoomed";
    ImGui::GetIO().KeyAlt = false;
    EXPECT_EQ(selected(), 0U) << tool;
  }
}

TEST_F(Hands, MoveTheCameraOverTheModelBesideToo) {
  session.add(ball(6));
  ASSERT_TRUE(session.execute("beside 1"));
  ui.view = {{0, 0}, {300, 400}};
  ui.beside = {{300, 0}, {300, 400}};
  for (const int button : {0, 1}) {
    const Eigen::Matrix4d before = camera();
    drag({450, 200}, {40, 20}, button);
    EXPECT_FALSE(camera().isApprox(before)) << button;
  }
  const double distance = session.camera.distance;
  ImGui::GetIO().MouseWheel = 1;
  frame({450, 200});
  ImGui::GetIO().MouseWheel = 0;
  EXPECT_LT(session.camera.distance, distance);
  // Tools are for the model on the left.
  ASSERT_TRUE(session.execute("tool brush"));
  const Eigen::Matrix4d before = camera();
  drag({450, 200}, {40, 10});
  EXPECT_TRUE(camera().isApprox(before));
  EXPECT_TRUE(session.models.back()->selecting.selection.faces().empty());
  EXPECT_EQ(selected(), 0U);
}

TEST_F(Hands, ThatPressAltInTheMiddleOfAStrokeEndTheStroke) {
  ASSERT_TRUE(session.execute("tool brush"));
  const Eigen::Matrix4d before = camera();
  frame({300, 200});
  ImGui::GetIO().MouseDown[0] = true;
  frame({300, 200});
  frame({310, 200});
  ImGui::GetIO().KeyAlt = true;
  frame({330, 210});
  ImGui::GetIO().MouseDown[0] = false;
  frame({330, 210});
  ImGui::GetIO().KeyAlt = false;
  EXPECT_TRUE(camera().isApprox(before));
  EXPECT_GT(selected(), 0U);
}

TEST_F(Hands, SeeWhatABrushWillSelectBeforeTheyLetGo) {
  ASSERT_TRUE(session.execute("tool brush"));
  const Selecting& selecting = session.models.front()->selecting;
  frame({300, 200});
  ImGui::GetIO().MouseDown[0] = true;
  frame({300, 200});
  const std::size_t first = selecting.drawn.size();
  EXPECT_GT(first, 0U);
  for (float x = 300; x <= 340; x += 5) frame({x, 200});
  const auto drawn = selecting.drawn;
  EXPECT_GT(drawn.size(), first);
  EXPECT_EQ(selected(), 0U) << "nothing is selected yet";
  ImGui::GetIO().MouseDown[0] = false;
  frame({340, 200});
  EXPECT_TRUE(selecting.drawn.empty());
  EXPECT_EQ(selecting.selection.faces(), drawn);
}

TEST_F(Hands, DrawOnBeforeTheStrokeBeforeHasBeenSelected) {
  ASSERT_TRUE(session.execute("tool brush"));
  const auto draw = [&](const ImVec2& from, bool shift) {
    ImGui::GetIO().KeyShift = shift;
    for (int i = 0; i < 8; ++i) look({from.x + 4 * static_cast<float>(i), from.y}, i > 0 && i < 7);
    ImGui::GetIO().KeyShift = false;
  };
  // Nothing takes what the background has found until all three are drawn.
  draw({240, 200}, false);
  EXPECT_TRUE(session.job.running());
  draw({340, 200}, true);
  draw({300, 150}, true);
  EXPECT_EQ(selected(), 0U);
  for (int i = 0; i < 3; ++i) frame({300, 300});
  EXPECT_EQ(session.models.front()->selecting.strokes.strokes.size(), 3U);
  EXPECT_GT(selected(), 30U);
  EXPECT_EQ(session.notice, "");
}

TEST_F(Hands, CancelAStrokeWithAllThatGoesOnFromIt) {
  ASSERT_TRUE(session.execute("tool brush"));
  const Selecting& selecting = session.models.front()->selecting;
  const auto draw = [&](const ImVec2& from, bool shift, bool lets_go = true) {
    ImGui::GetIO().KeyShift = shift;
    for (int i = 0; i < 8; ++i) look({from.x + 4 * static_cast<float>(i), from.y}, i > 0 && (i < 7 || !lets_go));
    ImGui::GetIO().KeyShift = false;
  };
  // A patch that stands: what refines another must not refine this one.
  draw({300, 260}, false);
  frame({10, 10});
  const auto before = selecting.selection.faces();
  ASSERT_GT(before.size(), 5U);
  draw({240, 200}, false);
  ASSERT_TRUE(session.job.running());
  draw({340, 200}, true);
  draw({300, 150}, true);
  ASSERT_TRUE(session.execute("cancel"));
  frame({10, 10});
  frame({10, 10});
  EXPECT_EQ(selecting.selection.faces(), before);
  EXPECT_EQ(selecting.strokes.strokes.size(), 1U);
  EXPECT_EQ(session.notice,
            "brushing was cancelled; everything is as it was; the 2 strokes that went on from it went with it");
  // A stroke that is still being drawn goes, too; one that begins anew does not.
  draw({240, 200}, false);
  ASSERT_TRUE(session.job.running());
  draw({340, 200}, true, false);
  ASSERT_TRUE(session.execute("cancel"));
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  look({370, 200}, true);
  look({370, 200}, false);
  frame({10, 10});
  EXPECT_EQ(selecting.selection.faces(), before);
  EXPECT_EQ(session.notice,
            "brushing was cancelled; everything is as it was; the stroke that went on from it went with it");
  draw({240, 200}, false);
  draw({340, 200}, true);
  draw({300, 150}, false);
  ASSERT_TRUE(session.execute("cancel"));
  frame({10, 10});
  frame({10, 10});
  EXPECT_EQ(selecting.strokes.strokes.size(), 1U);
  EXPECT_NE(selecting.selection.faces(), before) << "the last one stands on its own";
}

TEST_F(Hands, KnowWhichWorkTheirStrokesWentOnFromWhateverElseFails) {
  ASSERT_TRUE(session.execute("tool brush"));
  const Selecting& selecting = session.models.front()->selecting;
  const auto draw = [&](const ImVec2& from, bool shift) {
    ImGui::GetIO().KeyShift = shift;
    for (int i = 0; i < 8; ++i) look({from.x + 4 * static_cast<float>(i), from.y}, i > 0 && i < 7);
    ImGui::GetIO().KeyShift = false;
  };
  const auto end_job = [&] {
    while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  };
  // A file has its turn before the stroke that waits, and cannot be opened.
  draw({240, 200}, false);
  draw({340, 200}, true);
  end_job();
  ASSERT_TRUE(session.execute("open none.off"));
  frame({10, 10});
  frame({10, 10});
  EXPECT_EQ(selecting.strokes.strokes.size(), 2U);
  EXPECT_EQ(session.notice.find("stroke"), std::string::npos) << session.notice;
  // The first stroke is cancelled, which a file that fails after it does not hide.
  const auto before = selecting.selection.faces();
  draw({240, 260}, false);
  draw({340, 260}, true);
  ASSERT_TRUE(session.execute("cancel"));
  end_job();
  ASSERT_TRUE(session.execute("open none.off"));
  look({10, 10}, false);
  EXPECT_EQ(session.notice,
            "brushing was cancelled; everything is as it was; the stroke that went on from it went with it");
  frame({10, 10});
  EXPECT_EQ(selecting.selection.faces(), before);
  // Another model comes up.
  draw({240, 200}, false);
  draw({340, 200}, true);
  draw({300, 150}, true);
  end_job();
  session.add(ball(6));
  frame({10, 10});
  EXPECT_EQ(session.notice, "another model came up before 2 strokes could be carried out; draw them again");
  EXPECT_EQ(session.models.front()->selecting.strokes.strokes.size(), 1U);
}

TEST_F(Hands, SeeWhatABrushWillSelectWhileTheStrokeBeforeIsBeingSelected) {
  ASSERT_TRUE(session.execute("tool brush"));
  const Selecting& selecting = session.models.front()->selecting;
  const auto wait = [&](const ImVec2& at, const auto& until) {
    for (int i = 0; i < 5000 && !until(); ++i) {
      look(at, true);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  for (const bool down : {false, true, true, false}) look({240, 200}, down);
  ASSERT_TRUE(session.job.running()) << "nothing takes what it has found";
  for (const bool down : {false, true}) look({360, 200}, down);
  const auto right = session.pick({0.3, 0});
  ASSERT_TRUE(right);
  wait({360, 200}, [&] { return std::ranges::binary_search(selecting.drawn, right->face); });
  EXPECT_TRUE(std::ranges::binary_search(selecting.drawn, right->face));
  EXPECT_EQ(selected(), 0U);
  // The first one takes its place; the second one stays to be seen.
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  look({360, 200}, true);
  EXPECT_GT(selected(), 0U);
  EXPECT_TRUE(std::ranges::binary_search(selecting.drawn, right->face));
  frame({360, 200});
  look({360, 200}, false);
  frame({360, 200});
  EXPECT_TRUE(session.models.front()->selecting.selection.contains(right->face));
  EXPECT_TRUE(selecting.drawn.empty());
}

TEST_F(Hands, FindALoopWhereTheyDrewItHoweverTheCameraHasMovedSince) {
  ASSERT_TRUE(session.execute("camera 0 0"));
  const auto loop = [&] {
    ASSERT_TRUE(session.execute("tool lasso"));
    look({240, 140}, false);
    for (const ImVec2 at : {ImVec2{240, 140}, ImVec2{360, 140}, ImVec2{360, 260}, ImVec2{240, 260}}) look(at, true);
    look({240, 260}, false);
  };
  loop();
  frame({10, 10});
  const auto expected = session.models.front()->selecting.selection.faces();
  ASSERT_GT(expected.size(), 10U);
  ASSERT_TRUE(session.execute("tool brush"));
  for (const bool down : {false, true, true, false}) look({360, 200}, down);
  ASSERT_TRUE(session.job.running());
  loop();  // waits for the brush
  ASSERT_TRUE(session.execute("camera 90 20"));
  ASSERT_TRUE(session.execute("combine add"));
  const Eigen::Matrix4d moved = camera();
  frame({10, 10});
  frame({10, 10});
  EXPECT_EQ(session.models.front()->selecting.selection.faces(), expected) << "and no more: it was to replace";
  EXPECT_TRUE(camera().isApprox(moved, 1e-5));
  EXPECT_EQ(session.combine, sdk::Combine::Add);
}

TEST_F(Hands, UseKeys) {
  ImGuiIO& io = ImGui::GetIO();
  io.KeyMap[ImGuiKey_Enter] = 300;
  io.KeyMap[ImGuiKey_Escape] = 301;
  io.KeyMap[ImGuiKey_Tab] = 302;
  io.KeyMap[ImGuiKey_LeftArrow] = 303;
  io.KeyMap[ImGuiKey_RightArrow] = 304;
  io.KeyMap[ImGuiKey_UpArrow] = 305;
  io.KeyMap[ImGuiKey_DownArrow] = 306;
  const auto press = [&](int key, bool control = false) {
    io.KeyCtrl = control;
    for (const bool down : {true, false}) {
      io.KeysDown[key] = down;
      frame({300, 200});
    }
    io.KeyCtrl = false;
  };
  for (std::size_t tool = 0; tool < 6; ++tool) {
    press('1' + static_cast<int>(tool));
    EXPECT_EQ(session.tool, static_cast<Tool>(tool));
  }
  ASSERT_TRUE(session.execute("lasso -0.2 -0.2 0.2 -0.2 0.2 0.2 -0.2 0.2"));
  frame({300, 200});
  const std::size_t some = selected();
  EXPECT_GT(some, 0U);
  press('Z', true);
  EXPECT_EQ(selected(), 0U);
  press('Y', true);
  EXPECT_EQ(selected(), some);
  ASSERT_TRUE(session.execute("lasso -0.2 -0.2 0.2 -0.2 0.2 0.2 -0.2 0.2"));
  frame({300, 200});
  ASSERT_TRUE(session.execute("expand"));
  frame({300, 200});
  ASSERT_TRUE(session.execute("matches 1"));
  // Nobody sees on other pages what would be selected, nor in the city.
  ASSERT_TRUE(session.execute("panel look"));
  press(300);
  EXPECT_EQ(selected(), some);
  ASSERT_TRUE(session.execute("mode walk"));
  for (const char key : {'Z', 'Y'}) press(key, true);
  EXPECT_EQ(selected(), some);
  ASSERT_TRUE(session.execute("mode shapes"));
  ASSERT_TRUE(session.execute("panel edit"));
  press('Z', true);
  EXPECT_EQ(selected(), some);
  EXPECT_EQ(session.notice, "undo-edit: no edit was kept yet");
  press('Y', true);
  EXPECT_EQ(selected(), some);
  ASSERT_TRUE(session.execute("panel select"));
  press(300);
  EXPECT_GT(selected(), some) << "Enter takes the matches that are shown";
  // What is tried goes before what was kept.
  ASSERT_TRUE(session.execute("panel edit"));
  const Editing& editing = session.models.front()->editing;
  for (const char* line : {"similarity gls 0", "edit displace 0.01 map", "keep-edit", "edit displace 0.01 map"}) {
    ASSERT_TRUE(session.execute(line)) << line;
    frame({300, 200});
  }
  ASSERT_TRUE(editing.tried);
  press('Z', true);
  EXPECT_FALSE(editing.tried);
  EXPECT_EQ(editing.before.size(), 1U);
  press('Z', true);
  EXPECT_EQ(editing.before.size(), 0U);
  ASSERT_TRUE(session.execute("camera 10 10 50 0 0 0"));
  press('F');
  EXPECT_LT(session.camera.distance, 10);
  press(302);
  EXPECT_FALSE(ui.sidebar);
  // Escape cancels what runs, and takes nothing back that has been done.
  ASSERT_TRUE(session.execute("build"));
  io.KeysDown[301] = true;
  look({300, 200}, false);
  io.KeysDown[301] = false;
  frame({300, 200});
  EXPECT_NE(session.notice.find("cancelled"), std::string::npos) << session.notice;
  EXPECT_FALSE(session.models.front()->spheres);
  // Walking: W forwards, an arrow turns.
  ASSERT_TRUE(session.execute("mode walk"));
  for (int i = 0; i < 30; ++i) press('W');
  EXPECT_GT(session.walk.pose().x_m, 0.5);
  EXPECT_EQ(session.walk.pose().heading_rad, 0);
  for (int i = 0; i < 30; ++i) press(303);
  EXPECT_GT(session.walk.pose().heading_rad, 0.3) << "to the left";
}

/// Two balls in one skin: a waist between them, at the height 0.
std::shared_ptr<Model> waisted() {
  constexpr double kWaist = 0.25;
  auto model = ball();
  sdk::Mesh mesh = model->mesh->mesh;
  for (Vector3d& p : mesh.positions) {
    const double y = 2 * p.y();
    const double wide =
        kWaist + (1 - kWaist) * std::pow(std::sin(std::numbers::pi / 2 * std::min(1.0, std::abs(y))), 2);
    p = {wide * p.x(), y, wide * p.z()};
  }
  model->mesh = std::make_shared<const MeshShape>(std::move(mesh));
  return model;
}

TEST_F(Hands, SeeThePartGrowWhileTheyCut) {
  session.add(waisted());
  ASSERT_TRUE(session.execute("tool cut"));
  const Selecting& selecting = session.models.back()->selecting;
  frame({285, 199});
  ImGui::GetIO().MouseDown[0] = true;
  frame({285, 199});
  std::size_t seen = selecting.drawn.empty() ? 0 : 1;
  for (float x = 285; x <= 315; x += 3) {
    frame({x, 199});
    seen += selecting.drawn.empty() ? 0 : 1;
  }
  EXPECT_GT(seen, 5U);
  const auto drawn = selecting.drawn;
  const std::size_t half = session.models.back()->mesh->mesh.triangles.size() / 2;
  EXPECT_NEAR(static_cast<double>(drawn.size()), static_cast<double>(half), 0.1 * static_cast<double>(half));
  EXPECT_TRUE(selecting.selection.faces().empty()) << "nothing is selected yet";
  ImGui::GetIO().MouseDown[0] = false;
  frame({315, 199});
  EXPECT_TRUE(selecting.drawn.empty());
  EXPECT_EQ(selecting.selection.faces(), drawn);
  EXPECT_EQ(selecting.pieces, 1U);
}

TEST_F(Hands, DragTheBoundaryOfWhatIsSelected) {
  ASSERT_TRUE(session.execute("tool brush"));
  drag({220, 200}, {20, 0});
  const auto before = session.models.front()->selecting.selection.faces();
  ASSERT_FALSE(before.empty());
  ASSERT_TRUE(session.execute("tool edge"));
  // Where the selection ends on the right, and some way on.
  float x = 240;
  const auto is_selected = [&](float at) {
    const auto found = session.pick({(at - 300) / 200, 0});
    return found && session.models.front()->selecting.selection.contains(found->face);
  };
  while (x < 400 && is_selected(x)) x += 2;
  drag({x - 3, 200}, {70, 0});
  const auto& after = session.models.front()->selecting.selection;
  EXPECT_GT(after.faces().size(), before.size());
  EXPECT_TRUE(is_selected(x + 25));
  EXPECT_TRUE(session.models.front()->selecting.drawn.empty());
  ASSERT_TRUE(session.execute("undo"));
  EXPECT_TRUE(after.faces().empty()) << "the gesture that it refined";
}

TEST_F(Hands, AskWhatIsLikeASpot) {
  ASSERT_TRUE(session.execute("tool spot"));
  drag({300, 200}, {0, 0});
  EXPECT_EQ(session.models.front()->editing.similarity.size(), session.models.front()->mesh->mesh.positions.size());
  EXPECT_EQ(session.looks.map, MapKind::Compared);
}

TEST_F(Hands, ChangeTheBrushByTheWheel) {
  ASSERT_TRUE(session.execute("tool brush"));
  const double before = session.brush;
  ImGui::GetIO().MouseWheel = 3;
  frame({300, 200});
  ImGui::GetIO().MouseWheel = 0;
  EXPECT_GT(session.brush, 1.2 * before);
}

TEST_F(Hands, LeaveLinesThatDoTheSame) {
  drag({300, 200}, {60, 20});
  ASSERT_TRUE(session.execute("tool brush"));
  drag({300, 200}, {40, 10});
  ASSERT_TRUE(session.execute("combine add"));
  ASSERT_TRUE(session.execute("tool lasso"));
  frame({250, 150});
  ImGui::GetIO().MouseDown[0] = true;
  for (const ImVec2 at : {ImVec2{250, 150}, ImVec2{300, 140}, ImVec2{320, 260}, ImVec2{250, 250}}) frame(at);
  ImGui::GetIO().MouseDown[0] = false;
  frame({250, 250});
  Session again;
  again.add(ball());
  for (const std::string& line : session.log()) {
    ASSERT_TRUE(again.execute(line)) << line;
    while (again.job.running()) again.update(again.now + std::chrono::milliseconds(5));
  }
  EXPECT_EQ(again.models.front()->selecting.selection.faces(), session.models.front()->selecting.selection.faces());
  EXPECT_TRUE(again.camera.view_from_world().isApprox(session.camera.view_from_world(), 1e-5));
}

TEST_F(Hands, LetGoOfWhatIsHeldNoLonger) {
  for (const char* line : {"build", "level 4", "pose", "handle 0", "translate 0 0.2 0", "handle 0"}) {
    ASSERT_TRUE(session.execute(line)) << line;
    while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  }
  const Model& model = *session.models.front();
  const auto grip = session.camera.project(model.spheres->shape->spheres.front().centre);
  const ImVec2 from(300 + 200 * static_cast<float>(grip.x()), 200 - 200 * static_cast<float>(grip.y()));
  frame(from);
  ImGui::GetIO().MouseDown[0] = true;
  frame(from);
  frame({from.x + 30, from.y});
  EXPECT_NE(model.shown_mesh().positions, model.mesh->mesh.positions) << "a preview";
  // Ctrl+Z in the middle of the drag.
  ASSERT_TRUE(session.execute("undo"));
  frame({from.x + 60, from.y});
  EXPECT_EQ(model.shown_mesh().positions, model.mesh->mesh.positions);
  ImGui::GetIO().MouseDown[0] = false;
  frame({from.x + 60, from.y});
  ASSERT_TRUE(session.execute("handle 0"));
  frame({from.x + 90, from.y + 10});
  EXPECT_EQ(model.shown_mesh().positions, model.mesh->mesh.positions) << "that drag is over";
  EXPECT_EQ(model.pose->steps, 0U);
  // Nor is there anything to hold in the city.
  ASSERT_TRUE(session.execute("mode walk"));
  drag(from, {40, 0});
  EXPECT_EQ(model.pose->steps, 0U);
}

TEST_F(Hands, ChangeNothingThatAJobMayBeReading) {
  for (const char* line : {"build", "level 4", "pose", "handle 0"}) {
    ASSERT_TRUE(session.execute(line)) << line;
    while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  }
  const Model& model = *session.models.front();
  const auto grip = session.camera.project(model.spheres->shape->spheres.front().centre);
  const ImVec2 from(300 + 200 * static_cast<float>(grip.x()), 200 - 200 * static_cast<float>(grip.y()));
  frame(from);
  look(from, true);
  look({from.x + 30, from.y}, true);
  ASSERT_TRUE(follow_gizmo(ui)) << "a preview is being found";
  std::atomic<bool> done = false;
  session.start("reading", [&](const sdk::Task&) -> sdk::Expected<Job::Apply> {
    done.wait(false);
    return Job::Apply();
  });
  // Found long ago or not: it is not shown.
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(follow_gizmo(ui));
    EXPECT_EQ(model.previewed, nullptr);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  done = true;
  done.notify_all();
  frame({from.x + 30, from.y});
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  frame({from.x + 30, from.y});
  EXPECT_NE(model.previewed, nullptr) << "now it is";
}

TEST_F(Hands, WalkThroughTheCity) {
  ASSERT_TRUE(session.execute("mode walk"));
  frame({300, 200});
  ImGui::GetIO().MouseDown[0] = true;
  frame({300, 200});
  for (int i = 0; i < 60; ++i) frame({300, 100});
  ImGui::GetIO().MouseDown[0] = false;
  frame({300, 100});
  EXPECT_GT(session.walk.pose().x_m, 1) << "a drag upwards walks forward";
  EXPECT_NEAR(session.walk.pose().y_m, 0, 1e-9);
}

}  // namespace
}  // namespace armature::viewer
