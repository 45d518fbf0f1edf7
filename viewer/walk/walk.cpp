#include "viewer/walk/walk.h"

#include <cmath>
#include <utility>

#include <armature/navproto/endpoints.h>

namespace armature::viewer {
namespace {

using namespace std::chrono_literals;
using navproto::Engagement;
using navproto::StopReason;

/// Longer than this nothing is caught up with: the window stood still.
constexpr auto kLongestStep = std::chrono::milliseconds(250);
constexpr double kHalfHeight = 0.52;  // of the view, at depth 1

sdk::Expected<void> ours(navproto::Expected<void> result) {
  if (result) return {};
  return sdk::fail(result.error().message);
}

}  // namespace

sdk::Expected<void> Walk::connect(const std::string& endpoint, std::optional<navproto::CurveClient> curve) {
  if (const auto checked = navproto::endpoints_of(endpoint); !checked) return sdk::fail(checked.error().message);
  if (curve && !endpoint.starts_with("tcp:")) return sdk::fail(endpoint + ": keys are for tcp:// alone");
  disconnect();
  link_ = std::make_unique<DaemonLink>(endpoint, std::move(curve));
  return {};
}

sdk::Expected<void> Walk::start_daemon(const std::string& source) {
  auto daemon = DaemonProcess::start(source, programs);
  if (!daemon) return ours(tl::unexpected(daemon.error()));
  if (auto connected = connect(daemon->endpoint()); !connected) return connected;
  daemon_ = std::move(*daemon);
  return {};
}

void Walk::disconnect() {
  if (link_ || daemon_) {
    // Nobody waits until a daemon has ended, or an answer has failed to come.
    endings_.push_back(std::async(std::launch::async, [link = std::move(link_), daemon = std::move(daemon_)]() mutable {
      link.reset();
      daemon.reset();
    }));
  }
  link_.reset();
  daemon_.reset();
  navigation_.reset();
  skeleton_.reset();
  feed_.reset();
  health_.reset();
  settings_.reset();
  velocity_ = {};
  fresh_ = false;
  heard_.reset();
  error_.clear();
  rounds_ = 0;
}

void Walk::tell(std::string message, bool is_error) {
  message_ = std::move(message);
  message_is_error_ = is_error;
}

void Walk::take_answers() {
  while (const auto answer = link_->take_answer()) {
    const auto& [kind, reply] = *answer;
    if (!reply || !reply->error.empty()) {
      tell(reply ? reply->error : reply.error().message, true);
    } else if (kind == navproto::RequestKind::Save && daemon_) {
      const auto kept = daemon_->keep_settings();
      tell(kept ? "done: kept in " + kept->string() : kept.error().message, !kept);
    } else {
      tell("done", false);
    }
  }
}

void Walk::hear() {
  auto& stream = link_->stream();
  navigation_ = stream.navigation();
  skeleton_ = stream.skeleton();
  feed_ = link_->feed();
  health_ = stream.health();
  velocity_ = stream.velocity();
  settings_ = link_->settings();
  for (const auto& event : stream.take_events()) {
    // Our own daemon saves a copy; where that is kept, the answer to the request says.
    const bool of_copy = daemon_ && event.kind == navproto::EventKind::ConfigSaved;
    if (!event.header.replayed && !event.text.empty() && !of_copy) tell(event.text, false);
  }
  take_answers();
  if (auto error = link_->error(); error && *error != error_) {
    error_ = *error;
    tell(*std::move(error), true);
  }
}

/// A daemon of our own that has ended is started again.
void Walk::look_after_daemon() {
  if (daemon_->running()) return;
  const std::string source = daemon_->source();
  if (!heard_) {
    const std::string words = daemon_->last_words();
    disconnect();
    return tell(words.empty() ? "armatured ended at once" : words, true);
  }
  auto settings = settings_;
  const int rounds = rounds_ + 1;
  if (auto again = start_daemon(source); !again) return tell(again.error().message, true);
  rounds_ = rounds;
  if (settings) link_->request({.kind = navproto::RequestKind::Set, .settings = std::move(*settings)}, true);
}

void Walk::update(Time now) {
  std::erase_if(endings_, [](std::future<void>& ending) { return ending.wait_for(0s) == std::future_status::ready; });
  const auto step = advanced_ ? std::min<Time>(now - *advanced_, kLongestStep) : Time(0);
  advanced_ = now;
  if (link_) {
    const auto last = navigation_ ? navigation_->header.sequence : 0;
    hear();
    const bool was_fresh = fresh_;
    if (navigation_ && !navigation_->header.replayed && navigation_->header.sequence != last) heard_ = now;
    fresh_ = heard_ && now - *heard_ < 1s;
    if (was_fresh && !fresh_ && !daemon_)
      tell("the daemon at " + link_->endpoint() + " has fallen silent; waiting for it to come back", true);
    if (daemon_ && now - daemon_checked_ > 1s) {
      daemon_checked_ = now;
      look_after_daemon();
    }
  }
  const navproto::CameraPose before = camera_.pose();
  camera_.advance(velocity_, step);
  const navproto::CameraPose& after = camera_.pose();
  walked_m_ += std::hypot(after.x_m - before.x_m, after.y_m - before.y_m);
  if (task_) task_->update({after.x_m, after.y_m}, step);
}

sdk::Expected<void> Walk::request(navproto::ControlRequest request) {
  if (!link_) return sdk::fail("no daemon is connected; connect to one, or start one on a synthetic person");
  if (!link_->has_control())
    return sdk::fail("settings are changed on the daemon's own machine alone; connect there, by ipc://");
  link_->request(std::move(request));
  return {};
}

std::optional<std::string> Walk::take_message(bool& is_error) {
  if (message_.empty()) return std::nullopt;
  is_error = message_is_error_;
  return std::exchange(message_, {});
}

void Walk::start_path() {
  task_.emplace(city().path);
  place({});
  walked_m_ = 0;
}

const City& Walk::city() const {
  if (!city_) city_ = make_city();
  return *city_;
}

std::string Walk::state_in_words() const {
  if (!link_) return "No daemon. Walk with W A S D or the arrow keys, or start a synthetic person.";
  if (!navigation_ || !fresh_) return "Waiting for " + link_->endpoint();
  switch (navigation_->stop_reason) {
    case StopReason::TrackingLost: return "Tracking was lost: standing still until the person is seen again.";
    case StopReason::RestRequested: return "A new rest pose is being taken: stand still, relaxed.";
    case StopReason::EndOfStream: return "The recording has ended.";
    case StopReason::SourceFailed: return "The sensor has failed; the daemon tries to find it again.";
    case StopReason::Reload: return "The settings are being read again.";
    case StopReason::Exit: return "The daemon is stopping.";
    case StopReason::TooNoisy: return "A steering motion is too noisy to be steered with.";
    case StopReason::None:
    case StopReason::NoUser:
    case StopReason::NotEngaged: break;
  }
  switch (navigation_->engagement) {
    case Engagement::NoUser: return "Nobody is in front of the sensor.";
    case Engagement::Detected: return "Somebody is there. Stand still for a second to begin.";
    case Engagement::CapturingRest: return "Stand still, relaxed: the rest pose is being taken.";
    case Engagement::Engaged: return "Person " + std::to_string(navigation_->user_id) + " steers.";
    case Engagement::Suspended: return "Steering is suspended until the person is seen again.";
  }
  return {};
}

Camera Walk::camera(double aspect) const {
  const navproto::CameraPose& pose = camera_.pose();
  const Eigen::Vector3d forward(std::cos(pose.heading_rad), std::sin(pose.heading_rad), 0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Camera camera;
  camera.view_from_world.linear() << forward.cross(up).transpose(), up.transpose(), -forward.transpose();
  camera.view_from_world.translation() =
      -(camera.view_from_world.linear() * Eigen::Vector3d(pose.x_m, pose.y_m, kEyeHeight));
  camera.half_height = kHalfHeight;
  camera.half_width = kHalfHeight * aspect;
  camera.near = 0.2;
  camera.far = 320;
  return camera;
}

}  // namespace armature::viewer
