// Opening, choosing, closing and writing models.
#include <array>

#include "viewer/session/command.h"
#include "viewer/session/session.h"
#include "viewer/session/write_text.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;

Done open(Session& session, Arguments& arguments) {
  const std::string file = arguments.file();
  if (auto checked = arguments.check(); !checked) return checked;
  session.start("opening " + file_name(file), [&session, file](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
    auto model = read_model(file, task);
    if (!model) return tl::unexpected(model.error());
    return Job::Apply([&session, model = *model] { session.add(model); });
  });
  return {};
}

Done close(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  if (auto model = session.active(); !model) return tl::unexpected(model.error());
  session.discard(session.models[session.active_model]);
  session.models.erase(session.models.begin() + static_cast<std::ptrdiff_t>(session.active_model));
  session.beside = 0;
  session.choose(session.active_model == 0 ? 0 : session.active_model - 1);
  return {};
}

Done model(Session& session, Arguments& arguments) {
  if (auto any = session.active(); !any) return tl::unexpected(any.error());
  const std::size_t place = arguments.count("model", 1, session.models.size());
  if (auto checked = arguments.check(); !checked) return checked;
  session.choose(place - 1);
  return {};
}

Done beside(Session& session, Arguments& arguments) {
  if (auto any = session.active(); !any) return tl::unexpected(any.error());
  const std::size_t place = arguments.count("model", 0, session.models.size());
  if (auto checked = arguments.check(); !checked) return checked;
  session.beside = place;
  session.see_all();
  return {};
}

/// The lines so far, to be played again by --script.
Done save_session(Session& session, Arguments& arguments) {
  const std::string file = arguments.file();
  if (auto checked = arguments.check(); !checked) return checked;
  std::string text;
  for (const std::string& line : session.log()) text += line + '\n';
  if (auto written = write_text(file, text); !written) return written;
  session.tell("wrote " + file);
  return {};
}

Done save(Session& session, Arguments& arguments) {
  const std::string file = arguments.file();
  const bool spheres = arguments.left() > 0 && arguments.choice("what", {"mesh", "spheres"}) == 1;
  if (auto checked = arguments.check(); !checked) return checked;
  if (auto model = session.active(); !model) return tl::unexpected(model.error());
  session.start(
      "writing " + file_name(file),
      [&session, file, spheres,
       model = session.models[session.active_model]](const sdk::Task&) -> sdk::Expected<Job::Apply> {
        if (auto written = write_model(*model, file, spheres); !written) return tl::unexpected(written.error());
        return Job::Apply([&session, file] { session.tell("wrote " + file); });
      },
      Stops::Never);
  return {};
}

constexpr std::array kCommands = {
    Command{"beside", "N", "show the N-th model beside this one, seen alike; 0: none", beside, true},
    Command{"save-session", "FILE", "write all commands so far, to be played by --script FILE", save_session, true},
    Command{"open", "FILE", "open a mesh, a sphere-mesh (.ma, .ply) or a hierarchy (.smh)", open},
    Command{"close", "", "close the model that is shown", close},
    Command{"model", "N", "show the N-th of the models that are open", model},
    Command{"save", "FILE [mesh|spheres]",
            "write the mesh or the spheres, posed as they are, or the hierarchy, by the extension", save},
};

}  // namespace

std::span<const Command> file_commands() {
  return kCommands;
}

}  // namespace armature::viewer
