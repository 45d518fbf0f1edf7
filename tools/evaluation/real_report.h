#pragma once

#include <filesystem>
#include <string>

#include "tools/evaluation/real_evaluation.h"
#include "tools/json_lines.h"

namespace armature::tools {

/// Ours and just the paper, on the same recordings.
struct RealComparison {
  RealEvaluation ours;
  RealEvaluation paper;
};

/// A table for people.
void print_real(const RealComparison& real);

/// One JSON object a system, then one a sequence and system.
[[nodiscard]] Expected<void> write_real_json(const RealComparison& real);

/// SVG pictures in a folder that exists: real_deviation.svg, real_correlation.svg.
[[nodiscard]] Expected<void> write_real_plots(const RealComparison& real, const std::filesystem::path& folder);

}  // namespace armature::tools
