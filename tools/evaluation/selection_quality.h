#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/task.h>

#include "tools/evaluation/planted.h"

namespace armature::tools {

/// Something that is planted, and how it is looked for.
struct QualityCase {
  std::string name;
  PlantOptions options;
  std::function<PlantedScene(const PlantOptions&)> plant;
  std::function<sdk::Expected<sdk::Expansion>(const PlantedScene&, const sdk::Task&)> expand;
};

/// Patches, parts and components of our own shapes: clean, mirrored and in noise.
[[nodiscard]] sdk::Expected<std::vector<QualityCase>> planted_cases(const sdk::Task& task);
/// Patches and parts of models of that folder, among copies of them that are turned, scaled, bent and mirrored. Models
/// that are not there are left out.
[[nodiscard]] sdk::Expected<std::vector<QualityCase>> model_cases(const std::filesystem::path& models,
                                                                  const sdk::Task& task);

/// The mean over the seeds 1 to `seeds`.
[[nodiscard]] sdk::Expected<PlantedQuality> mean_quality(const QualityCase& of, int seeds, const sdk::Task& task);

}  // namespace armature::tools
