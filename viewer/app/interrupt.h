#pragma once

namespace armature::viewer {

/// From now on the first SIGINT (Ctrl-C), SIGTERM or SIGHUP asks the program to end, so that it can end what it started
/// and leave nothing behind; a second one kills as usual.
void catch_interrupts();

/// Whether one has come.
[[nodiscard]] bool interrupted() noexcept;

}  // namespace armature::viewer
