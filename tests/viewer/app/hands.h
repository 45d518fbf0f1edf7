#pragma once

#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "viewer/app/gestures.h"

namespace armature::viewer {

/// A ball of radius 1 in so many rings of faces.
inline std::shared_ptr<Model> ball(std::size_t rings = 24) {
  const std::size_t sides = 2 * rings;
  sdk::Mesh mesh;
  for (std::size_t ring = 0; ring <= rings; ++ring) {
    const double polar = std::numbers::pi * static_cast<double>(ring) / static_cast<double>(rings);
    for (std::size_t side = 0; side < sides; ++side) {
      const double around = 2 * std::numbers::pi * static_cast<double>(side) / static_cast<double>(sides);
      mesh.positions.emplace_back(std::sin(polar) * std::sin(around), std::cos(polar),
                                  std::sin(polar) * std::cos(around));
    }
  }
  const auto vertex = [&](std::size_t ring, std::size_t side) { return sdk::VertexId(ring * sides + side % sides); };
  for (std::size_t ring = 0; ring < rings; ++ring) {
    for (std::size_t side = 0; side < sides; ++side) {
      if (ring + 1 < rings)
        mesh.triangles.push_back({vertex(ring, side), vertex(ring + 1, side), vertex(ring + 1, side + 1)});
      if (ring > 0) mesh.triangles.push_back({vertex(ring, side), vertex(ring + 1, side + 1), vertex(ring, side + 1)});
    }
  }
  auto model = std::make_shared<Model>();
  model->name = "ball";
  model->mesh = std::make_shared<const MeshShape>(std::move(mesh));
  return model;
}

/// A session with a ball in a view of 600x400, and a mouse.
class Hands : public ::testing::Test {
 protected:
  void SetUp() override {
    context = ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {600, 400};
    io.DeltaTime = 1.0F / 60;
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    ui.view = {{0, 0}, {600, 400}};
    session.aspect = 1.5;
    session.add(ball());
    frame({300, 200});
  }
  void TearDown() override { ImGui::DestroyContext(context); }

  void frame(const ImVec2& mouse) {
    ImGui::GetIO().MousePos = mouse;
    ImGui::NewFrame();
    handle_input(ui);
    ImGui::EndFrame();
    while (session.job.running() || ui.following) {
      session.update(session.now + std::chrono::milliseconds(5));
      ui.following = follow_gesture(ui);
    }
  }
  /// A frame that takes nothing of what the background has found.
  void look(const ImVec2& mouse, bool down) {
    ImGui::GetIO().MouseDown[0] = down;
    ImGui::GetIO().MousePos = mouse;
    ImGui::NewFrame();
    handle_input(ui);
    ImGui::EndFrame();
  }
  /// Presses, moves in steps and lets go.
  void drag(const ImVec2& from, const ImVec2& by, int button = 0) {
    frame(from);
    ImGui::GetIO().MouseDown[button] = true;
    for (int i = 0; i <= 8; ++i)
      frame({from.x + by.x * static_cast<float>(i) / 8, from.y + by.y * static_cast<float>(i) / 8});
    ImGui::GetIO().MouseDown[button] = false;
    frame({from.x + by.x, from.y + by.y});
  }
  [[nodiscard]] Eigen::Matrix4d camera() const { return session.camera.view_from_world().matrix(); }
  [[nodiscard]] std::size_t selected() const { return session.models.front()->selecting.selection.faces().size(); }

  ImGuiContext* context = nullptr;
  Session session;
  Ui ui{.commanded = session};
};

}  // namespace armature::viewer
