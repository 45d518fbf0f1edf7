#pragma once

namespace armature {

/// Has the log of the whole process go to stderr, a line an event. Where stderr is the journal's (JOURNAL_STREAM, see
/// systemd.exec) each line begins with its priority ("<4>": warning) and has no clock, which the journal has; elsewhere
/// with the time. `quiet`: errors only. Call once, before anything is logged.
void log_to_stderr(bool quiet);

/// The one line that says why the program ends.
void log_failure(const char* why);

}  // namespace armature
