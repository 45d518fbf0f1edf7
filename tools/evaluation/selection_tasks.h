#pragma once

#include <string>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/task.h>

#include "tools/evaluation/planted.h"

namespace armature::tools {

/// What the participants of the thesis's annex B.2 were asked to select, on a model that stands in for theirs: what
/// they would draw to select one of the regions, and where all of them are. What is drawn becomes the scene's
/// reference.
struct SelectionTask {
  std::string name;
  PlantedScene scene;
  sdk::Expansion expansion;  ///< of the region that the gesture selects
};

/// The tasks: the legs of an ant, the bumps of average size on a ball, the eyes of a face, the hands of a figure.
[[nodiscard]] sdk::Expected<std::vector<SelectionTask>> selection_tasks(const sdk::Task& task);

}  // namespace armature::tools
