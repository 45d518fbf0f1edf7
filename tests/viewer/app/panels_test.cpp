// What panels issue, without a window.
#include <chrono>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/viewer/app/hands.h"

namespace armature::viewer {
namespace {

TEST_F(Hands, LetGoOfTheLevelsSliderWhileWorkGoesOnAndLookElsewhere) {
  for (const char* line : {"build", "level 8"}) {
    ASSERT_TRUE(session.execute(line));
    while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  }
  const std::shared_ptr<Model> model = session.models.front();
  ui.slide = {.model = model, .wanted = 5, .waits = true};
  ASSERT_TRUE(session.execute("map curvature"));
  ASSERT_TRUE(session.execute("panel look"));
  follow_level(ui);
  EXPECT_EQ(model->spheres->cursor->size(), 8U) << "it waits";
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
  follow_level(ui);
  EXPECT_EQ(model->spheres->cursor->size(), 5U);
  // It is no other model's, and jumps to nothing later.
  ui.slide.waits = true;
  session.add(ball(6));
  follow_level(ui);
  EXPECT_FALSE(ui.slide.waits);
  EXPECT_EQ(session.notice, "");
}

/// All facts of a session but what it has said, lines that failed, and what it still measures.
std::map<std::string, std::string> facts_of(const Session& session) {
  auto facts = session.report();
  std::erase_if(facts, [](const auto& fact) {
    return fact.first == "notice" || fact.first == "failures" || fact.first.ends_with("measured") ||
           fact.first.ends_with("_percent");
  });
  return facts;
}

void carry_out(Session& session, const std::string& line) {
  static_cast<void>(session.execute(line));
  while (session.job.running()) session.update(session.now + std::chrono::milliseconds(5));
}

TEST_F(Hands, ClickNothingInAPanelThatAScriptDoesNotHold) {
  ImGui::GetIO().DisplaySize = {690, 800};
  std::size_t clicked = 0;
  for (const std::vector<std::string>& lines : {std::vector<std::string>{"panel look"},
                                                {"panel spheres"},
                                                {"pose", "handle 0"},
                                                {"panel select"},
                                                {"tool brush"},
                                                {"similarity gls 0", "panel edit", "edit displace 0.01 map"}}) {
    Session used;
    Ui panels{.commanded = used, .view = {{290, 0}, {400, 764}}};
    used.add(ball(6));
    for (const char* line : {"lasso -0.2 -0.2 0.2 -0.2 0.2 0.2 -0.2 0.2", "expand", "build", "level 8"})
      carry_out(used, line);
    for (const std::string& line : lines) carry_out(used, line);
    const std::size_t before = used.log().size();
    const auto draw = [&](const ImVec2& mouse, bool down) {
      ImGui::GetIO().MousePos = mouse;
      ImGui::GetIO().MouseDown[0] = down;
      ImGui::NewFrame();
      draw_sidebar(panels);
      follow_level(panels);
      ImGui::EndFrame();
      for (int waited = 0; used.job.running(); ++waited) {
        used.update(used.now + std::chrono::milliseconds(5));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        // What takes long is none of this test's business: cancelled, it leaves everything as it was.
        if (waited == 200) static_cast<void>(used.execute("cancel"));
      }
    };
    // From below the buttons that open dialogs on.
    for (float y = 100; y < 560; y += 9) {
      for (const float x : {40.F, 110.F, 180.F, 250.F}) {
        for (const bool down : {false, true, false}) draw({x, y}, down);
        panels.log = false;
        if (used.models.size() > 1) carry_out(used, "close");  // what is made of it is made once
        ASSERT_FALSE(panels.dialog);
      }
    }
    clicked += used.log().size() - before;
    Session again;
    again.aspect = used.aspect;
    again.add(ball(6));
    for (const std::string& line : used.log()) carry_out(again, line);
    EXPECT_EQ(facts_of(again), facts_of(used)) << lines.back();
  }
  EXPECT_GT(clicked, 100U);
}

}  // namespace
}  // namespace armature::viewer
