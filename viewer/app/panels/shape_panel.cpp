// How shapes look, and their sphere-meshes.
#include <algorithm>
#include <array>
#include <cmath>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

/// Whether mesh and spheres are shown: on the pages of both.
void draw_shown(Ui& ui, const Model& model) {
  const Session& session = ui.session;
  if (model.mesh) {
    const int mesh = choice_row("mesh", static_cast<int>(session.looks.mesh), {"Mesh", "Glass", "Hidden"});
    if (mesh >= 0) ui.issue("mesh {}", kMeshLooks[static_cast<std::size_t>(mesh)]);
  }
  if (model.spheres) {
    const int spheres =
        choice_row("spheres", static_cast<int>(session.looks.spheres), {"Spheres", "Structure", "Hidden"});
    if (spheres >= 0) ui.issue("spheres {}", kSpheresLooks[static_cast<std::size_t>(spheres)]);
  }
}

void draw_looks(Ui& ui, const Model& model) {
  const Session& session = ui.session;
  section("Shown");
  draw_shown(ui, model);
  if (model.mesh) {
    bool wireframe = session.looks.wireframe, matcap = session.looks.matcap;
    if (ImGui::Checkbox("Wireframe", &wireframe)) ui.issue("wireframe {}", wireframe ? "on" : "off");
    ImGui::SameLine();
    if (ImGui::Checkbox("Matcap", &matcap)) ui.issue("matcap {}", matcap ? "on" : "off");
    int map = static_cast<int>(session.looks.map);
    ImGui::SetNextItemWidth(-1);
    static constexpr std::array<const char*, 6> kNames = {"Own colours",        "Curvature",  "What protrudes",
                                                          "Like the selection", "Components", "As compared"};
    if (ImGui::Combo("##map", &map, kNames.data(), static_cast<int>(kNames.size())))
      ui.issue("map {}", kMaps[static_cast<std::size_t>(map)]);
  }
  section("Seen from");
  if (ImGui::Button("Fit")) ui.issue("fit");
  struct Side {
    const char* name;
    int azimuth, elevation;
  };
  for (const Side& side : {Side{"Front", 0, 0}, Side{"Side", 90, 0}, Side{"Top", 0, 89}}) {
    ImGui::SameLine();
    if (ImGui::Button(side.name)) ui.issue("camera {} {}", side.azimuth, side.elevation);
  }
  const int up = choice_row("up", static_cast<int>(session.camera.view.up), {"X up", "Y up", "Z up"});
  if (up >= 0) ui.issue("up {}", std::array{"x", "y", "z"}[static_cast<std::size_t>(up)]);
}

std::string counted(std::size_t number, const char* thing) {
  return fmt::format("{} {}{}", number, thing, number == 1 ? "" : "s");
}

/// With two digits that count, however small.
std::string percent(double value) {
  constexpr double kLeast = 1e-6;
  if (value < kLeast) return fmt::format("under {:.6f}", kLeast);
  const int before = static_cast<int>(std::floor(std::log10(value)));
  return fmt::format("{:.{}f}", value, std::max(2, 1 - before));
}

void draw_level(Ui& ui, const SphereShape& spheres, bool has_mesh, bool posed) {
  LevelSlide& slide = ui.slide;
  if (spheres.hierarchy) {
    // A level is a number of spheres; half of the slider is for the first few hundred.
    const auto least = static_cast<int>(spheres.hierarchy->min_spheres());
    const auto most = static_cast<int>(spheres.hierarchy->leaf_count());
    // Of a posed mesh a level takes a while: it changes once the slider is let go.
    if (!slide.active && !slide.waits)
      slide.wanted = static_cast<int>(posed ? spheres.shape->spheres.size() : spheres.cursor->size());
    ImGui::SetNextItemWidth(-1);
    const bool moved = ImGui::SliderInt("##level", &slide.wanted, least, most, "%d spheres",
                                        ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    slide.active = ImGui::IsItemActive();
    if (posed ? ImGui::IsItemDeactivatedAfterEdit() : moved) slide.waits = true;
  }
  const sdk::SphereMesh& shape = *spheres.shape;
  const std::string parts = counted(shape.edges.size(), "edge") + ", " + counted(shape.triangles.size(), "triangle");
  // The slider says how many spheres there are.
  hint((spheres.hierarchy ? parts : counted(shape.spheres.size(), "sphere") + ", " + parts).c_str());
  if (!has_mesh || posed) return;
  if (spheres.errors) {
    // Two lines always, so that nothing below moves.
    ImGui::Text("Error: %s", error_words(*spheres.errors, "\n").c_str());
  } else if (spheres.unmeasured.empty()) {
    ImGui::TextDisabled("Error: being measured\n ");
  } else {
    ImGui::TextDisabled("Error: cannot be measured\n ");
  }
  if (!spheres.unmeasured.empty()) return explain(spheres.unmeasured.c_str());
  explain(spheres.errors && spheres.errors->about
              ? "Distance from the mesh to the sphere-mesh at some thousand points, of the diagonal of its bounding box"
              : "Distance from the mesh to the sphere-mesh, of the diagonal of its bounding box");
}

}  // namespace

std::string error_words(const LevelErrors& errors, const char* between) {
  return fmt::format("mean {}{} %{}largest {}{} %", errors.about ? "about " : "",
                     percent(errors.mean_input_to_approximation), between, errors.about ? "at least " : "",
                     percent(errors.hausdorff));
}

void follow_level(Ui& ui) {
  LevelSlide& slide = ui.slide;
  const Session& session = ui.session;
  if (!slide.waits || session.job.running()) return;
  slide.waits = false;
  const auto model = slide.model.lock();
  if (model && !session.models.empty() && session.models[session.active_model] == model)
    ui.issue("level {}", slide.wanted);
}

void draw_shape_panel(Ui& ui) {
  draw_looks(ui, *ui.session.models[ui.session.active_model]);
}

void draw_sphere_panel(Ui& ui) {
  const Session& session = ui.session;
  const auto shown = session.models[session.active_model];
  const Model& model = *shown;
  if (ui.slide.model.lock() != shown) ui.slide = {.model = shown};
  section("Spheres");
  ImGui::PushID(&model);                                        // the mouse holds no other model's slider
  const bool busy = session.job.running() && !ui.slide.active;  // what is disabled cannot be dragged on
  ImGui::BeginDisabled(busy);
  if (model.spheres) draw_level(ui, *model.spheres, model.mesh != nullptr, model.posing != nullptr);
  if (model.mesh && model.spheres) draw_shown(ui, model);
  if (model.mesh && (!model.spheres || !model.spheres->hierarchy)) {
    if (accent_button("Abstract to spheres", -1)) ui.issue("build");
    if (!model.spheres) hint("Makes every level at once, from a sphere a vertex to a single one.");
  }
  if (model.spheres) {
    if (model.mesh) {
      if (ImGui::Button("Refine")) ui.issue("refine");
      explain("Fits these spheres closer to the mesh");
      ImGui::SameLine();
    }
    if (ImGui::Button("Extract a mesh")) ui.issue("extract");
  }
  if (model.mesh && model.spheres && model.spheres->hierarchy && !model.posing && session.other() == nullptr) {
    if (ImGui::Button("Beside one that joins what is alike", {-1, 0})) ui.issue("build-alike");
    explain("Builds a hierarchy that joins like regions together; one slider moves both");
  }
  ImGui::EndDisabled();
  ImGui::PopID();
}

}  // namespace armature::viewer
