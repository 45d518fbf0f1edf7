#include "viewer/session/posing.h"

#include <utility>

namespace armature::viewer {

sdk::Expected<std::shared_ptr<Posing>> Posing::begin(std::shared_ptr<const MeshShape> mesh,
                                                     std::shared_ptr<const sdk::Hierarchy> hierarchy,
                                                     std::size_t spheres, const sdk::Task& task) {
  auto session = sdk::DeformationSession::start(mesh->mesh, *hierarchy, spheres, {}, task);
  if (!session) return tl::unexpected(session.error());
  return std::shared_ptr<Posing>(new Posing(std::move(mesh), std::move(hierarchy), std::move(*session)));
}

Posing::Posing(std::shared_ptr<const MeshShape> mesh, std::shared_ptr<const sdk::Hierarchy> hierarchy,
               sdk::DeformationSession session)
    : rest_(std::move(mesh)), hierarchy_(std::move(hierarchy)), session_(std::move(session)) {}

std::size_t Posing::steps() const {
  const std::string text = session_.text();
  std::size_t steps = 0;
  for (const std::string_view verb : {"\nmove ", "\npin ", "\nunpin "})
    for (std::size_t at = text.find(verb); at != std::string::npos; at = text.find(verb, at + 1)) ++steps;
  return steps;
}

sdk::Expected<void> Posing::replay(std::string_view text, std::string_view name) {
  const std::size_t before = steps();
  auto done = session_.replay(text, name);
  if (!done)
    for (std::size_t more = steps(); more > before; --more) session_.undo();
  return done;
}

}  // namespace armature::viewer
