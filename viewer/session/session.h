#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <armature/sdk/error.h>

#include "viewer/session/arguments.h"
#include "viewer/session/job.h"
#include "viewer/session/model.h"
#include "viewer/session/orbit_camera.h"
#include "viewer/walk/walk.h"

namespace armature::viewer {

/// What there is to say where something needs the mesh at rest, and it is being posed.
inline constexpr const char* kPutBackFirst = "put the mesh back, or keep it as a model, first: `unpose` or `bake`";

/// What goes on while a level is made that has many spheres.
inline constexpr const char* kLevelTitle = "changing the level";

enum class Mode : std::uint8_t { Shapes, Walk };
enum class Panel : std::uint8_t { Look, Spheres, Select, Edit };
enum class Tool : std::uint8_t { Look, Click, Cut, Brush, Lasso, Edge, Pose, Spot };
enum class MeshLook : std::uint8_t { Solid, Glass, Off };
enum class SpheresLook : std::uint8_t { Surface, Structure, Off };
enum class MapKind : std::uint8_t { None, Curvature, Protrusion, Similarity, Components, Compared };

///@{
/// How scripts spell them, in the order of the enumerations.
inline const std::vector<std::string_view> kModes = {"shapes", "walk"};
inline const std::vector<std::string_view> kPanels = {"look", "spheres", "select", "edit"};
inline const std::vector<std::string_view> kTools = {"look", "click", "cut", "brush", "lasso", "edge", "pose", "spot"};
inline const std::vector<std::string_view> kMeshLooks = {"solid", "glass", "off"};
inline const std::vector<std::string_view> kSpheresLooks = {"surface", "structure", "off"};
inline const std::vector<std::string_view> kCombines = {"replace", "add", "subtract", "intersect"};  ///< sdk::Combine
inline const std::vector<std::string_view> kMaps = {"none",       "curvature",  "protrusion",
                                                    "similarity", "components", "compared"};
///@}

/// How shapes are shown.
struct Looks {
  MeshLook mesh = MeshLook::Solid;
  SpheresLook spheres = SpheresLook::Surface;
  MapKind map = MapKind::None;
  bool wireframe = false;
  bool matcap = false;  ///< light by the normal alone; else corners are darker
};

/// What was found under a place of the view.
struct Picked {
  sdk::FaceId face = {};                            ///< of the mesh, if it is the nearest
  sdk::SphereId sphere = {};                        ///< of the sphere-mesh, if that is
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in the model's coordinates
};

/// How a job has ended, if it has.
enum class Outcome : std::uint8_t { Open, Done, Undone };

/// Where a line comes from.
struct Origin {
  std::string place = {};  ///< in a file, with a colon; or empty
  bool may_fail = true;    ///< that it, or its work, fails does not count, as of all that is done by hand
};

/// A picture that a script asks for; whoever draws makes it.
struct PictureRequest {
  std::string file = {};
  std::optional<PictureSize> size = {};  ///< or that of the window
  int turn = 0;                          ///< instead, so many pictures of a whole turn are timed
  Origin origin = {};                    ///< of the line that asks for it
};

/// Everything that is open and how it is seen. It changes by commands alone: lines of text that panels issue, that
/// `log()` keeps and that a script replays. It knows no window and no OpenGL. Used by one thread.
class Session {
 public:
  using Time = std::chrono::nanoseconds;  ///< by any monotonic clock

  Session();
  ~Session();

  /// Carries a line out. What it starts in the background may still fail: `notice` tells. A failure leaves everything
  /// as it was and is returned and shown as `notice`, too.
  sdk::Expected<void> execute(std::string_view line);
  /// Takes what the background has finished and moves what moves. Call it once a frame.
  void update(Time now);
  /// The lines that were carried out, in order, as a script replays them: what was done while work went on that then
  /// came to its end is done `meanwhile`.
  [[nodiscard]] const std::vector<std::string>& log() const noexcept { return log_; }

  /// Whether work runs in the background that the next line of a script has to wait for.
  [[nodiscard]] bool busy() const { return job.running() || waits(); }
  /// Whether it has been told to wait, and what for had not come at the last `update()`.
  [[nodiscard]] bool waits() const { return waiting != nullptr; }

  /// The model that commands are about; fails where nothing is open.
  [[nodiscard]] sdk::Expected<Model*> active();
  /// The same, which must have a mesh or spheres.
  [[nodiscard]] sdk::Expected<Model*> active_mesh();
  [[nodiscard]] sdk::Expected<Model*> active_spheres();
  /// The same, whose mesh is not posed,
  [[nodiscard]] sdk::Expected<std::shared_ptr<Model>> active_unposed();
  /// nor shown with an edit, so that what is made of it is of what is shown.
  [[nodiscard]] sdk::Expected<std::shared_ptr<Model>> active_at_rest();
  /// Starts a job in the name of the line that is being carried out; it is logged once the job has succeeded.
  void start(std::string title, Job::Work work, Stops stops = Stops::Anywhere);
  /// Opens a model, chooses it and sees all of it.
  void add(std::shared_ptr<Model> model);
  /// Chooses a model that is open, where any is, and sees all of it: never with its only shape hidden, nor with a map
  /// that it has no values of.
  void choose(std::size_t place);
  /// Shows a map on a model; its values by vertex, or none. Nobody has values of another map.
  void show_map(Model& on, MapKind map, std::vector<float> values);
  /// A sphere around the models that are shown.
  [[nodiscard]] sdk::Sphere around() const;
  /// Lets the camera see all of the models that are shown, from where it looks.
  void see_all();
  /// The model that is shown beside the active one, or none.
  [[nodiscard]] Model* other() const;
  /// What is seen at a place of the view, if anything is.
  [[nodiscard]] std::optional<Picked> pick(const ViewPoint& at) const;
  /// Facts by name, for scripts to print and to expect.
  [[nodiscard]] std::map<std::string, std::string> report() const;

  std::vector<std::shared_ptr<Model>> models;
  std::size_t active_model = 0;
  std::size_t beside = 0;  ///< the number of a model that is shown beside it, from 1; 0: none
  Mode mode = Mode::Shapes;
  Panel panel = Panel::Look;
  Tool tool = Tool::Look;
  Looks looks;
  OrbitCamera camera;
  double aspect = 1.6;  ///< width over height, of the view or of both views together
  double brush = 0.05;  ///< radius, of the active model's size
  sdk::Combine combine = sdk::Combine::Replace;
  std::optional<Picked> picked;
  Walk walk;

  Job job;
  /// Of the last job that was begun; another one has another. Undone: it was cancelled or has failed.
  std::shared_ptr<const Outcome> job_outcome;
  Job preparing;                          ///< what the tool in hand will need; nothing waits for it
  std::function<bool()> waiting;          ///< a script waits until it is true; `update()` asks
  std::optional<PictureRequest> picture;  ///< is to be made; the script waits
  std::string notice;                     ///< the last failure or what to know, for people
  bool notice_is_error = false;
  Time notice_since{0};  ///< what is no error goes after a while
  Origin origin;         ///< of the line that is carried out next
  /// What of all that may not has failed first, a script's line or its work or an expectation, after its place.
  std::optional<std::string> failure;
  std::size_t failures = 0;  ///< how many lines have failed, those that may as well
  bool quit = false;
  ///@{
  /// The longest that a window took for a frame, waiting aside, since that was last told: by the clock, and in
  /// processor time of its thread.
  Time longest_frame{0}, longest_work{0};
  ///@}
  Time now{0};

  void tell(std::string text, bool error = false);
  /// Tells what has failed of a line.
  void tell_failure(const Origin& of, const std::string& why);
  /// Lets things go where that holds nothing up: those of a large model take a while.
  void discard(std::shared_ptr<const void> unwanted);
  void discard(std::initializer_list<std::shared_ptr<const void>> unwanted) {
    for (const auto& thing : unwanted) discard(thing);
  }

 private:
  void measure_levels();
  void measure(const std::shared_ptr<Model>& model, bool quick);
  void prepare_tool();
  void clear_out();
  void forget_error(std::string_view command);
  void take_job();

  std::vector<std::string> log_;
  std::string line_, pending_line_;  // being carried out; whose job runs
  Origin pending_origin_;            // its
  std::shared_ptr<Outcome> pending_outcome_;
  std::size_t pending_at_ = 0;  // where that belongs in the log: after what was carried out before it
  Job measuring_;
  std::vector<std::shared_ptr<const void>> unwanted_;
  Job discarding_;
  struct Resting {
    std::weak_ptr<const Model> model = {};  // whose spheres are seen,
    std::uint64_t revision = 0;             // which of them,
    Time since{0};
  };
  std::array<Resting, 2> resting_;           // of the active model, and of the one beside it
  Resting measured_;                         // what is or was measured last
  std::weak_ptr<const MeshShape> prepared_;  // what cutting needs of it is there, or being made
};

}  // namespace armature::viewer
