// A dialog that opens and saves files.
#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace fs = std::filesystem;

/// What the dialog remembers while the program runs.
struct FileDialog {
  fs::path folder;
  fs::path listed;  // whose entries these are
  std::vector<fs::path> folders, files;
  std::array<char, 512> name{};
  std::string complaint;
};

namespace {

bool can_be_opened(const fs::path& path) {
  static const std::set<std::string> kExtensions = {".off", ".obj",  ".ply", ".stl", ".ma",
                                                    ".smh", ".gltf", ".glb", ".dae", ".3ds"};
  return kExtensions.contains(lower_extension(path));
}

void list(FileDialog& dialog) {
  if (dialog.listed == dialog.folder) return;
  dialog.listed = dialog.folder;
  dialog.folders.clear();
  dialog.files.clear();
  dialog.complaint.clear();
  std::error_code error;
  for (fs::directory_iterator entry(dialog.folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path name = entry->path().filename();
    if (name.string().starts_with('.')) continue;
    std::error_code unknown;  // a link that leads nowhere
    if (entry->is_directory(unknown)) {
      dialog.folders.push_back(name);
    } else if (can_be_opened(name)) {
      dialog.files.push_back(name);
    }
  }
  if (error) dialog.complaint = "this folder cannot be read: " + error.message();
  std::sort(dialog.folders.begin(), dialog.folders.end());
  std::sort(dialog.files.begin(), dialog.files.end());
}

/// Goes into a folder; opens a file, or writes it.
void choose(Ui& ui, FileDialog& dialog, const fs::path& name) {
  const fs::path file = dialog.folder / name;
  std::error_code none;
  if (fs::is_directory(file, none)) {
    dialog.folder = fs::canonical(file, none);
    dialog.name.fill(0);
    return;
  }
  ui.issue("{} {}", ui.saving ? "save" : "open", as_word(file.string()));
  dialog.listed.clear();
  ui.dialog = false;
}

}  // namespace

void draw_file_dialog(Ui& ui) {
  std::error_code none;
  if (!ui.files) {
    ui.files = std::make_shared<FileDialog>();
    ui.files->folder = fs::current_path(none);
  }
  FileDialog& dialog = *ui.files;
  list(dialog);
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const ImVec2 size(std::min(ui.px(520), window.x - ui.px(16)), std::min(ui.px(480), window.y - ui.px(16)));
  ImGui::SetNextWindowPos({(window.x - size.x) / 2, (window.y - size.y) / 2}, ImGuiCond_Appearing);
  ImGui::SetNextWindowSize(size, ImGuiCond_Appearing);
  ImGui::SetNextWindowFocus();
  ImGui::Begin(ui.saving ? "Save as" : "Open", &ui.dialog,
               ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse);
  ImGui::TextWrapped("%s", dialog.folder.c_str());
  if (!dialog.complaint.empty()) ImGui::TextColored({0.73F, 0.2F, 0.16F, 1}, "%s", dialog.complaint.c_str());
  ImGui::BeginChild("entries", {0, -2.6F * ImGui::GetFrameHeightWithSpacing()});
  if (dialog.folder.has_parent_path() && ImGui::Selectable("..", false)) dialog.folder = dialog.folder.parent_path();
  const fs::path here = dialog.folder;
  for (const fs::path& folder : dialog.folders)
    if (ImGui::Selectable((folder.string() + "/").c_str(), false)) dialog.folder = here / folder;
  for (const fs::path& file : dialog.files) {
    if (ImGui::Selectable(file.c_str(), false, ImGuiSelectableFlags_AllowDoubleClick)) {
      dialog.name.fill(0);
      file.string().copy(dialog.name.data(), dialog.name.size() - 1);
      if (ImGui::IsMouseDoubleClicked(0) && !ui.saving) choose(ui, dialog, file);
    }
  }
  ImGui::EndChild();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  const bool entered = ImGui::InputTextWithHint(
      "##name", ui.saving ? "name.obj, .ply, .ma, .smh ..." : "name of a file", dialog.name.data(), dialog.name.size(),
      ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
  const bool replaces =
      ui.saving && dialog.name[0] != 0 && fs::is_regular_file(dialog.folder / dialog.name.data(), none);
  const bool confirmed = accent_button(replaces ? "Replace" : ui.saving ? "Save" : "Open");
  ImGui::SameLine();
  if (ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ui.dialog = false;
  if (replaces) {
    ImGui::SameLine();
    ImGui::TextDisabled("it is there already");
  }
  if ((confirmed || (entered && !replaces)) && dialog.name[0] != 0) choose(ui, dialog, dialog.name.data());
  ImGui::End();
}

}  // namespace armature::viewer
