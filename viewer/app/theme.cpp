#include "viewer/app/theme.h"

#include <array>
#include <cmath>
#include <filesystem>

namespace armature::viewer::theme {
namespace {

struct Face {
  const char* regular;
  const char* bold;
};

/// Where Debian's packages fonts-inter and fonts-dejavu-core put theirs; without either, ImGui's own.
constexpr std::array<Face, 2> kFaces = {{
    {"/usr/share/fonts/opentype/inter/Inter-Regular.otf", "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf"},
    {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"},
}};

/// What files may be called: Latin letters and their extensions, Greek, Cyrillic; and punctuation.
constexpr std::array<ImWchar, 9> kLetters = {0x20, 0x24F, 0x370, 0x3FF, 0x400, 0x52F, 0x2010, 0x205E, 0};

/// In the order of `load_fonts()`; its first where there is but one.
ImFont* font(int which) {
  const auto& fonts = ImGui::GetIO().Fonts->Fonts;
  return fonts[which < fonts.Size ? which : 0];
}

void load_fonts(float scale) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  std::error_code error;
  for (const Face& face : kFaces) {
    if (!std::filesystem::exists(face.regular, error) || !std::filesystem::exists(face.bold, error)) continue;
    // Whole pixels keep letters sharp.
    atlas.AddFontFromFileTTF(face.regular, std::round(15 * scale), nullptr, kLetters.data());
    atlas.AddFontFromFileTTF(face.bold, std::round(15 * scale));
    atlas.AddFontFromFileTTF(face.bold, std::round(24 * scale));
    return;
  }
  ImFontConfig config;
  config.SizePixels = std::round(13 * scale);
  atlas.AddFontDefault(&config);
}

ImVec4 colour(ImU32 packed) {
  return ImGui::ColorConvertU32ToFloat4(packed);
}

ImVec4 accent(float alpha) {
  ImVec4 result = colour(kAccent);
  result.w = alpha;
  return result;
}

}  // namespace

void apply(float scale) {
  load_fonts(scale);
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 8;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = style.TabRounding = 5;
  style.ScrollbarRounding = 8;
  style.ScrollbarSize = 11;
  style.GrabMinSize = 12;
  style.WindowBorderSize = style.FrameBorderSize = style.PopupBorderSize = 0;
  style.WindowPadding = {14, 12};
  style.FramePadding = {9, 5};
  style.ItemSpacing = {8, 7};
  style.ItemInnerSpacing = {6, 5};
  style.ScaleAllSizes(scale);
  ImVec4* const colours = style.Colors;
  colours[ImGuiCol_Text] = colour(kInk);
  colours[ImGuiCol_TextDisabled] = colour(kDim);
  colours[ImGuiCol_WindowBg] = colour(kPaper);
  colours[ImGuiCol_PopupBg] = colour(kPaper);
  colours[ImGuiCol_FrameBg] = {0.92F, 0.925F, 0.93F, 1};
  colours[ImGuiCol_FrameBgHovered] = {0.88F, 0.89F, 0.90F, 1};
  colours[ImGuiCol_FrameBgActive] = {0.85F, 0.86F, 0.88F, 1};
  colours[ImGuiCol_Button] = {0.905F, 0.912F, 0.92F, 1};
  colours[ImGuiCol_ButtonHovered] = {0.86F, 0.875F, 0.89F, 1};
  colours[ImGuiCol_ButtonActive] = accent(0.35F);
  colours[ImGuiCol_Header] = accent(0.14F);
  colours[ImGuiCol_HeaderHovered] = accent(0.20F);
  colours[ImGuiCol_HeaderActive] = accent(0.28F);
  colours[ImGuiCol_SliderGrab] = accent(0.55F);
  colours[ImGuiCol_SliderGrabActive] = accent(0.8F);
  colours[ImGuiCol_CheckMark] = accent(1);
  colours[ImGuiCol_PlotHistogram] = accent(1);
  colours[ImGuiCol_NavHighlight] = accent(0.8F);
  colours[ImGuiCol_Separator] = colour(kFaint);
  colours[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
}

ImFont* heading() {
  return font(1);
}

ImFont* large() {
  return font(2);
}

}  // namespace armature::viewer::theme
