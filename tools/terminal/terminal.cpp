#include "tools/terminal/terminal.h"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace armature::tools {
namespace {

// Alternate screen, no cursor, no wrapping at the right edge; and back.
constexpr std::string_view kTakeOver = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[2J";
constexpr std::string_view kGiveBack = "\x1b[0m\x1b[?7h\x1b[?25h\x1b[?1049l";
// The terminal shows what lies between these at once, where it knows them.
constexpr std::string_view kBeginFrame = "\x1b[?2026h";
constexpr std::string_view kEndFrame = "\x1b[?2026l";

void write_out(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view{} : std::string_view{value};
}

ColourDepth colour_depth() {
  if (!environment("NO_COLOR").empty()) return ColourDepth::None;
  const auto colours = environment("COLORTERM");
  return colours == "truecolor" || colours == "24bit" ? ColourDepth::TrueColour : ColourDepth::Palette256;
}

}  // namespace

Terminal::Terminal() : depth_(colour_depth()), keys_(isatty(STDIN_FILENO) == 1) {
  if (keys_ && tcgetattr(STDIN_FILENO, &settings_) == 0) {
    termios unbuffered = settings_;
    unbuffered.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    // A background job would be stopped by the terminal for touching its settings.
    keys_ = tcgetpgrp(STDIN_FILENO) == getpgrp() && tcsetattr(STDIN_FILENO, TCSANOW, &unbuffered) == 0;
  } else {
    keys_ = false;
  }
  write_out(kTakeOver);
}

Terminal::~Terminal() {
  write_out(kGiveBack);
  if (keys_) tcsetattr(STDIN_FILENO, TCSANOW, &settings_);
}

bool Terminal::there() {
  const auto kind = environment("TERM");
  return isatty(STDOUT_FILENO) == 1 && !kind.empty() && kind != "dumb";
}

Screen Terminal::blank() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
  return {size.ws_col, size.ws_row};
}

void Terminal::show(const Screen& screen) {
  const std::string update = ansi_update(shown_, screen, depth_);
  if (update.empty()) return;
  write_out(std::string(kBeginFrame) + update + std::string(kEndFrame));
  shown_ = screen;
}

char Terminal::key() {
  if (!keys_) return 0;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (poll(&input, 1, 0) == 1 && (input.revents & POLLIN) != 0 && read(STDIN_FILENO, &key, 1) == 1) return key;
  return 0;
}

}  // namespace armature::tools
