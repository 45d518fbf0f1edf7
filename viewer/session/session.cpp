#include "viewer/session/session.h"

#include <algorithm>
#include <utility>

#include <armature/sdk/distance/measure.h>

#include "viewer/session/arguments.h"
#include "viewer/session/command.h"
#include "viewer/session/extent.h"

namespace armature::viewer {
namespace {

/// Points at which the error of a level is measured, quickly and in full.
constexpr std::size_t kQuickSamples = 10'000, kLevelSamples = 20'000;
/// Measuring more spheres in full takes more than seconds.
constexpr std::size_t kMostMeasured = 2'000;
/// How long a notice that is no error is shown.
constexpr auto kNoticeStays = std::chrono::seconds(8);
/// How long a level must stand before its error is worth measuring.
constexpr auto kLevelRests = std::chrono::milliseconds(150);

/// Lines of which only the last one in a row matters: a slider, a camera that is being moved.
bool replaces_itself(std::string_view name) {
  return name == "camera" || name == "level" || name == "matches" || name == "brush-size" || name == "place" ||
         name == "edit" || name == "transfer";
}

std::string_view first_word(std::string_view line) {
  return line.substr(0, line.find(' '));
}

/// Arguments and all, but no comment.
std::size_t words_in(std::string_view line) {
  const auto words = split_words(line);
  return words ? words->size() : 0;
}

/// Whether nothing is left of what a line did once another has been carried out right after it: that is the same
/// command, with as many arguments (a camera may keep where it stands).
bool replaces(std::string_view line, std::string_view before) {
  return replaces_itself(first_word(line)) && first_word(line) == first_word(before) &&
         words_in(line) >= words_in(before);
}

/// Whether a model's level is an approximation that can be measured.
bool has_error(const Model* model) {
  return model != nullptr && model->mesh && !model->posing && model->spheres && !model->spheres->shape->spheres.empty();
}

/// Waiting and expecting are no actions: the log leaves them out.
bool is_about_scripts(const Command& command) {
  const auto commands = script_commands();
  return &command >= commands.data() && &command < commands.data() + commands.size();
}

}  // namespace

Session::Session() = default;
Session::~Session() = default;

void Session::tell(std::string text, bool error) {
  notice = std::move(text);
  notice_is_error = error;
  notice_since = now;
}

void Session::tell_failure(const Origin& of, const std::string& why) {
  tell(why, true);
  ++failures;
  if (!of.may_fail && !failure) failure = of.place + why;
}

/// What failed is old news once something else has been done; to look at it from elsewhere is not that.
void Session::forget_error(std::string_view command) {
  if (notice_is_error && !replaces_itself(command)) tell("");
}

sdk::Expected<void> Session::execute(std::string_view line) {
  const auto fails = [&](const std::string& why) -> sdk::Expected<void> {
    tell_failure(origin, why);
    return sdk::fail(why);
  };
  auto words = split_words(line);
  if (!words) return fails(words.error().message);
  if (words->empty()) return {};
  const std::string name = words->front();
  const Command* command = find_command(name);
  if (command == nullptr) return fails(as_word(name) + " is no command; `help` lists them");
  if (job.running() && !command->while_busy)
    return fails(job.title() + " is still going on: wait for it, or cancel it, then try again");
  words->erase(words->begin());
  Arguments arguments(std::move(*words));
  line_ = std::string(line);
  const bool was_running = job.running();
  if (auto done = command->run(*this, arguments); !done) return fails(name + ": " + done.error().message);
  if (job.running() && !was_running) {
    pending_line_ = line_;
    pending_origin_ = origin;
    pending_at_ = log_.size();
    return {};
  }
  if (is_about_scripts(*command)) return {};
  forget_error(name);
  // What a job began with stays before it.
  const std::size_t first = job.running() ? pending_at_ : 0;
  if (log_.size() > first && replaces(line_, log_.back())) log_.pop_back();
  log_.push_back(line_);
  return {};
}

void Session::start(std::string title, Job::Work work, Stops stops) {
  job_outcome = pending_outcome_ = std::make_shared<Outcome>(Outcome::Open);
  job.start(std::move(title), std::move(work), stops);
}

void Session::take_job() {
  const auto done = job.poll();
  if (!done) return;
  if (pending_outcome_) *pending_outcome_ = *done ? Outcome::Done : Outcome::Undone;
  if (*done) {
    forget_error(first_word(pending_line_));
    // What was done meanwhile was done before this had its effect.
    for (std::size_t i = pending_at_; i < log_.size(); ++i) log_[i] = "meanwhile " + log_[i];
    if (pending_at_ > 0 && replaces(pending_line_, log_[pending_at_ - 1]))
      log_.erase(log_.begin() + static_cast<std::ptrdiff_t>(--pending_at_));
    log_.insert(log_.begin() + static_cast<std::ptrdiff_t>(pending_at_), pending_line_);
  } else if (done->error().kind == sdk::ErrorKind::Cancelled) {
    tell(job.title() + " was cancelled; everything is as it was");
  } else {
    tell_failure(pending_origin_, done->error().message);
  }
}

void Session::discard(std::shared_ptr<const void> unwanted) {
  if (unwanted) unwanted_.push_back(std::move(unwanted));
}

/// What is not wanted any more goes with a job of its own.
void Session::clear_out() {
  static_cast<void>(discarding_.poll());
  if (unwanted_.empty() || discarding_.running()) return;
  discarding_.start("clearing out", [unwanted = std::exchange(unwanted_, {})](const sdk::Task&) mutable {
    unwanted.clear();
    return sdk::Expected<Job::Apply>(Job::Apply());
  });
}

void Session::update(Time time) {
  now = time;
  take_job();
  clear_out();
  walk.update(time);
  bool is_error = false;
  if (auto message = walk.take_message(is_error)) tell(std::move(*message), is_error);
  if (!notice_is_error && now - notice_since > kNoticeStays) notice.clear();
  measure_levels();
  prepare_tool();
  if (waiting && waiting()) waiting = nullptr;
}

/// Once a level that is seen has stood for a moment, its error is measured in the background: quickly, and then in full
/// where that is a matter of seconds. One at a time, the active model's first; what is not seen any more is not
/// measured.
void Session::measure_levels() {
  const auto done = measuring_.poll();
  const bool failed = done && !*done && done->error().kind != sdk::ErrorKind::Cancelled;
  std::array<std::shared_ptr<Model>, 2> seen;
  if (!models.empty()) seen[0] = models[active_model];
  if (other() != nullptr) seen[1] = models[beside - 1];
  bool is_seen = false;  // what is being measured
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!has_error(seen[i].get())) seen[i].reset();
    const std::uint64_t revision = seen[i] ? seen[i]->spheres_revision : 0;
    if (resting_[i].model.lock() != seen[i] || resting_[i].revision != revision) resting_[i] = {seen[i], revision, now};
    if (!seen[i] || measured_.model.lock() != seen[i] || measured_.revision != revision) continue;
    is_seen = true;
    if (failed) seen[i]->spheres->unmeasured = done->error().message;
  }
  if (!is_seen) measuring_.cancel();
  if (measuring_.running()) return;
  for (const bool quick : {true, false}) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!seen[i] || !seen[i]->spheres->unmeasured.empty() || now - resting_[i].since < kLevelRests) continue;
      const SphereShape& level = *seen[i]->spheres;
      const bool is_due = quick ? !level.errors : level.errors->about && level.shape->spheres.size() <= kMostMeasured;
      if (!is_due) continue;
      measured_ = resting_[i];
      return measure(seen[i], quick);
    }
  }
}

void Session::measure(const std::shared_ptr<Model>& model, bool quick) {
  measuring_.start("measuring",
                   [quick, mesh = model->mesh, shape = model->spheres->shape, revision = model->spheres_revision,
                    weak = std::weak_ptr<Model>(model)](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                     const auto errors = sdk::measure(
                         mesh->mesh, *shape, {.samples = quick ? kQuickSamples : kLevelSamples, .quick = quick}, task);
                     if (!errors) return tl::unexpected(errors.error());
                     return Job::Apply([=, found = *errors] {
                       const auto still = weak.lock();
                       if (still && still->spheres && still->spheres_revision == revision)
                         still->spheres->errors = LevelErrors{found, quick};
                     });
                   });
}

/// What cutting needs of a large mesh takes a while: it is made as soon as the tool is chosen, not after the stroke.
void Session::prepare_tool() {
  static_cast<void>(preparing.poll());  // the cut will tell what fails
  const bool cuts = mode == Mode::Shapes && tool == Tool::Cut && !models.empty();
  const std::shared_ptr<const MeshShape> mesh = cuts ? models[active_model]->mesh : nullptr;
  if (mesh == prepared_.lock()) return;
  if (preparing.running()) return preparing.cancel();
  prepared_ = mesh;
  if (!mesh) return;
  preparing.start("getting ready to cut", [mesh](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
    if (const auto parts = mesh->parts(task); !parts) return tl::unexpected(parts.error());
    return Job::Apply();
  });
}

sdk::Expected<Model*> Session::active() {
  if (models.empty()) return sdk::fail("nothing is open; open a model first");
  return models[active_model].get();
}

sdk::Expected<Model*> Session::active_mesh() {
  auto model = active();
  if (model && !(*model)->mesh) return sdk::fail((*model)->name + " is a sphere-mesh; this needs a triangle mesh");
  return model;
}

sdk::Expected<Model*> Session::active_spheres() {
  auto model = active();
  if (model && !(*model)->spheres) return sdk::fail((*model)->name + " has no sphere-mesh yet; build one first");
  return model;
}

sdk::Expected<std::shared_ptr<Model>> Session::active_unposed() {
  const auto model = active_mesh();
  if (!model) return tl::unexpected(model.error());
  if ((*model)->posing) return sdk::fail(kPutBackFirst);
  return models[active_model];
}

sdk::Expected<std::shared_ptr<Model>> Session::active_at_rest() {
  auto model = active_unposed();
  if (model && (*model)->editing.tried)
    return sdk::fail("keep the edit that is shown, or drop it, first: `keep-edit` or `drop-edit`");
  return model;
}

void Session::add(std::shared_ptr<Model> model) {
  models.push_back(std::move(model));
  mode = Mode::Shapes;
  choose(models.size() - 1);
}

void Session::choose(std::size_t place) {
  active_model = place;
  picked.reset();
  if (models.empty()) return;
  const Model& model = *models[place];
  const bool has_map = looks.map == MapKind::Components ? model.mesh != nullptr : !model.values.empty();
  if (!has_map) looks.map = MapKind::None;
  if (model.mesh && !model.spheres && looks.mesh == MeshLook::Off) looks.mesh = MeshLook::Solid;
  if (model.spheres && !model.mesh && looks.spheres == SpheresLook::Off) looks.spheres = SpheresLook::Surface;
  see_all();
}

void Session::show_map(Model& on, MapKind map, std::vector<float> values) {
  for (const auto& model : models) {
    if (map == looks.map || model->values.empty()) continue;
    model->values.clear();
    ++model->colour_revision;
  }
  on.values = std::move(values);
  ++on.colour_revision;
  looks.map = map;
}

void Session::see_all() {
  sdk::Sphere all = models.empty() ? around() : models[active_model]->lasting_extent();
  const Model* second = other();
  if (second != nullptr) all = widened(all, second->lasting_extent());
  camera.fit(all, second != nullptr ? aspect / 2 : aspect);
}

sdk::Sphere Session::around() const {
  if (models.empty()) return {Eigen::Vector3d::Zero(), 1};
  return models[active_model]->around();
}

Model* Session::other() const {
  return beside == 0 || beside > models.size() || beside - 1 == active_model ? nullptr : models[beside - 1].get();
}

std::optional<Picked> Session::pick(const ViewPoint& at) const {
  if (models.empty()) return std::nullopt;
  Model& model = *models[active_model];
  const sdk::Ray ray = camera.ray(at);
  std::optional<Picked> found;
  double nearest = 0;
  if (model.mesh && !model.posing && looks.mesh != MeshLook::Off) {  // posed, it does not lie where its tree has it
    if (const auto hit = model.mesh->surface.tree.intersect(ray)) {
      found = Picked{.face = hit->face, .point = ray.origin + hit->t * ray.direction};
      nearest = hit->t;
    }
  }
  if (model.spheres && looks.spheres != SpheresLook::Off) {
    if (const auto hit = model.sphere_tree().intersect(ray); hit && (!found || hit->t < nearest)) {
      Eigen::Index most = 0;
      hit->weights.maxCoeff(&most);
      found =
          Picked{.sphere = hit->spheres[static_cast<std::size_t>(most)], .point = ray.origin + hit->t * ray.direction};
    }
  }
  return found;
}

}  // namespace armature::viewer
