#pragma once

#include <termios.h>

#include "tools/terminal/screen.h"

namespace armature::tools {

/// A terminal taken over for a picture that redraws in place, on its alternate screen, and given back as it was. Needs
/// there(); reads keys where stdin is one, too. One at a time.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Whether stdout is a terminal that can place its cursor.
  [[nodiscard]] static bool there();
  /// An empty screen of the terminal's present size.
  [[nodiscard]] static Screen blank();
  /// Brings the terminal from what it shows to this picture.
  void show(const Screen& screen);
  /// A key pressed since the last call, 0 for none. Does not wait.
  [[nodiscard]] char key();

 private:
  ColourDepth depth_;
  Screen shown_{1, 1};
  bool keys_;
  termios settings_{};
};

}  // namespace armature::tools
