#pragma once

namespace armature::tools {

/// Forgets how much memory the process has held so far, where the kernel allows it.
void reset_peak_memory() noexcept;

/// The most memory that the process held since then (or since it began), in mebibytes; 0 where the kernel does not say.
[[nodiscard]] double peak_memory_mb() noexcept;

}  // namespace armature::tools
