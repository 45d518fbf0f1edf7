// A dialog that opens and saves files.
#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace fs = std::filesystem;

namespace {

/// What a file is chosen for.
struct Use {
  const char *title, *command, *button, *hint;
  bool writes, of_moves;
};
constexpr std::array<Use, 4> kUses = {
    {{"Open", "open", "Open", "name of a file", false, false},
     {"Save as", "save", "Save", "name.obj, .ply, .ma, .smh ...", true, false},
     {"Save the steps", "save-pose", "Save", "name.moves", true, true},
     {"Replay steps", "replay-pose", "Replay", "name of a file of steps", false, true}}};

const Use& use_of(const Ui& ui) {
  return kUses[static_cast<std::size_t>(ui.file_use)];
}

}  // namespace

/// What the dialog remembers while the program runs.
struct FileDialog {
  fs::path folder;
  fs::path listed;  // whose entries these are
  std::vector<fs::path> folders, files;
  std::array<char, 512> name{};
  std::string complaint;
};

namespace {

bool can_be_chosen(const fs::path& path, const Use& use) {
  if (use.of_moves) return lower_extension(path) == ".moves";
  static const std::set<std::string> kExtensions = {".off", ".obj",  ".ply", ".stl", ".ma",
                                                    ".smh", ".gltf", ".glb", ".dae", ".3ds"};
  return kExtensions.contains(lower_extension(path));
}

void list(FileDialog& dialog, const Use& use) {
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
    } else if (can_be_chosen(name, use)) {
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
  ui.issue("{} {}", use_of(ui).command, as_word(file.string()));
  dialog.listed.clear();
  ui.dialog = false;
}

}  // namespace

void ask_for_file(Ui& ui, FileUse use) {
  const bool of_moves = use_of(ui).of_moves;
  ui.dialog = true;
  ui.file_use = use;
  if (!ui.files) return;
  ui.files->listed.clear();  // others may have changed it since
  if (use_of(ui).of_moves != of_moves) ui.files->name.fill(0);
}

void draw_file_dialog(Ui& ui) {
  std::error_code none;
  if (!ui.files) {
    ui.files = std::make_shared<FileDialog>();
    ui.files->folder = fs::current_path(none);
  }
  FileDialog& dialog = *ui.files;
  const Use& use = use_of(ui);
  list(dialog, use);
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const ImVec2 size(std::min(ui.px(520), window.x - ui.px(16)), std::min(ui.px(480), window.y - ui.px(16)));
  ImGui::SetNextWindowPos({(window.x - size.x) / 2, (window.y - size.y) / 2}, ImGuiCond_Appearing);
  ImGui::SetNextWindowSize(size, ImGuiCond_Appearing);
  ImGui::SetNextWindowFocus();
  ImGui::SetNextWindowSizeConstraints({1, 1}, {window.x - ui.px(16), window.y - ui.px(16)});
  ImGui::Begin(use.title, &ui.dialog, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse);
  // Wherever it was dragged to, and however small the window has become, all of it is seen.
  const ImVec2 at = ImGui::GetWindowPos(), wide = ImGui::GetWindowSize();
  ImGui::SetWindowPos({std::clamp(at.x, 0.F, std::max(0.F, window.x - wide.x)),
                       std::clamp(at.y, 0.F, std::max(0.F, window.y - wide.y))});
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
      if (ImGui::IsMouseDoubleClicked(0) && !use.writes) choose(ui, dialog, file);
    }
  }
  ImGui::EndChild();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  const bool entered =
      ImGui::InputTextWithHint("##name", use.hint, dialog.name.data(), dialog.name.size(),
                               ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
  const bool replaces =
      use.writes && dialog.name[0] != 0 && fs::is_regular_file(dialog.folder / dialog.name.data(), none);
  const bool confirmed = accent_button(replaces ? "Replace" : use.button);
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
