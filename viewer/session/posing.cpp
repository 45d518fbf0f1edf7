#include "viewer/session/posing.h"

#include <utility>

#include "viewer/session/extent.h"

namespace armature::viewer {
namespace {

/// A tree of so many spheres takes no time.
constexpr std::size_t kFewSpheres = 2000;

}  // namespace

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

std::shared_ptr<Pose> Posing::pose(bool to_stay) const {
  auto pose = std::make_shared<Pose>();
  pose->mesh = rest_->mesh;
  pose->mesh.positions.assign(session_.positions().begin(), session_.positions().end());
  pose->shape = std::make_shared<const sdk::SphereMesh>(session_.shape());
  pose->around = widened(sphere_around(pose->mesh), sphere_around(*pose->shape));
  for (std::size_t sphere = 0; sphere < pose->shape->spheres.size(); ++sphere)
    pose->pinned.push_back(session_.is_pinned(sdk::SphereId(sphere)));
  pose->steps = session_.steps();
  if (to_stay && pose->shape->spheres.size() > kFewSpheres)
    pose->tree = std::make_shared<const sdk::SphereMeshTree>(*pose->shape);
  return pose;
}

template <class Step>
Posing::Laid Posing::after(const Step& step) {
  const std::lock_guard lock(mutex_);
  if (sdk::Expected<void> done = step(); !done) return tl::unexpected(done.error());
  return pose(true);
}

std::string Posing::text() const {
  const std::lock_guard lock(mutex_);
  return session_.text();
}

Posing::Laid Posing::lies() const {
  const std::lock_guard lock(mutex_);
  return pose(true);
}

Posing::Laid Posing::move(const sdk::SphereMove& move) {
  return after([&] { return session_.move(move); });
}

Posing::Laid Posing::preview(const sdk::SphereMove& move) {
  const std::lock_guard lock(mutex_);
  if (const auto done = session_.preview(move); !done) return tl::unexpected(done.error());
  return pose(false);
}

Posing::Laid Posing::go_to(std::size_t spheres) {
  return after([&] { return session_.go_to(spheres); });
}

Posing::Laid Posing::pin(std::span<const sdk::SphereId> spheres, bool pinned) {
  return after([&] { return session_.pin(spheres, pinned); });
}

Posing::Laid Posing::replay(std::string_view text, std::string_view name, const sdk::Task& task) {
  return after([&] { return session_.replay(text, name, task); });
}

Posing::Laid Posing::undo() {
  return after(
      [&]() -> sdk::Expected<void> { return session_.undo() ? sdk::Expected<void>() : sdk::fail(kNothingToUndo); });
}

Posing::Laid Posing::redo() {
  return after(
      [&]() -> sdk::Expected<void> { return session_.redo() ? sdk::Expected<void>() : sdk::fail(kNothingToRedo); });
}

sdk::Expected<void> lay(Session& session, std::string title,
                        std::function<Posing::Laid(Posing&, const sdk::Task&)> change, const Laying& laying) {
  session.start(
      std::move(title),
      [change = std::move(change), lets_go = laying.lets_go,
       model = session.models[session.active_model]](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
        auto laid = change(*model->posing, task);
        if (!laid) return tl::unexpected(laid.error());
        return Job::Apply([model, lets_go, pose = std::move(*laid)] {
          if (lets_go) model->handle.clear();
          model->lay(pose);
        });
      },
      laying.stops);
  return {};
}

}  // namespace armature::viewer
