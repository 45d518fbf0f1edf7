#include "sdk/io/assimp.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sdk/io/file_bytes.h"
#include "sdk/io/polygons.h"

namespace armature::sdk {
namespace {

/// What is to be read: a file, or bytes whose format `name` tells.
struct Source {
  std::string name;
  std::optional<std::string_view> bytes = {};
};

/// The functions of assimp's C interface that are used.
class Assimp {
 public:
  /// Fails when the shared library is not installed.
  static Expected<Assimp> load() {
    void* const library = dlopen("libassimp.so.5", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return fail("expected OFF, OBJ, PLY, STL or XYZ; other formats need assimp (libassimp5)");
    Assimp assimp;
    const bool complete = find(library, "aiCreatePropertyStore", assimp.create_properties) &&
                          find(library, "aiSetImportPropertyInteger", assimp.set_integer) &&
                          find(library, "aiImportFileExWithProperties", assimp.import_file) &&
                          find(library, "aiImportFileFromMemoryWithProperties", assimp.import_bytes) &&
                          find(library, "aiIsExtensionSupported", assimp.is_supported) &&
                          find(library, "aiGetErrorString", assimp.error);
    if (!complete) return fail("assimp: expected version 5");
    return assimp;
  }

  decltype(&aiCreatePropertyStore) create_properties = nullptr;
  decltype(&aiSetImportPropertyInteger) set_integer = nullptr;
  decltype(&aiImportFileExWithProperties) import_file = nullptr;
  decltype(&aiImportFileFromMemoryWithProperties) import_bytes = nullptr;
  decltype(&aiIsExtensionSupported) is_supported = nullptr;
  decltype(&aiGetErrorString) error = nullptr;

 private:
  template <class Function>
  static bool find(void* library, const char* name, Function& out) {
    out = reinterpret_cast<Function>(dlsym(library, name));
    return out != nullptr;
  }
};

Expected<void> append(const aiMesh& part, bool coloured, Polygons& polygons) {
  const std::size_t first = polygons.positions.size();
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& p = part.mVertices[i];
    polygons.positions.emplace_back(p.x, p.y, p.z);
    if (!coloured) continue;
    const aiColor4D& colour = part.mColors[0][i];
    polygons.vertex_colours.push_back(colour_of_fractions(double{colour.r}, double{colour.g}, double{colour.b}));
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices < 3 || face.mNumIndices > kMostCorners)
      return fail("expected faces of 3 to 10000 corners; found one of " + std::to_string(face.mNumIndices));
    polygons.counts.push_back(face.mNumIndices);
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= part.mNumVertices) return fail("expected corners that name a vertex");
      polygons.corners.emplace_back(first + face.mIndices[k]);
    }
  }
  return {};
}

/// Imports with assimp, all parts in one and in the place where the scene has them.
Expected<Mesh> import(const Source& source) {
  const auto assimp = Assimp::load();
  if (!assimp) return tl::unexpected(assimp.error());
  aiPropertyStore* const properties = assimp->create_properties();
  assimp->set_integer(properties, AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  assimp->set_integer(properties, AI_CONFIG_PP_RVC_FLAGS,
                      aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_TEXCOORDS |
                          aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS | aiComponent_TEXTURES | aiComponent_LIGHTS |
                          aiComponent_CAMERAS | aiComponent_MATERIALS);
  constexpr unsigned kSteps = aiProcess_RemoveComponent | aiProcess_SortByPType | aiProcess_PreTransformVertices |
                              aiProcess_JoinIdenticalVertices | aiProcess_ValidateDataStructure;
  const std::string extension = std::filesystem::path(source.name).extension().string();
  const aiScene* const scene =
      source.bytes ? assimp->import_bytes(source.bytes->data(), static_cast<unsigned>(source.bytes->size()), kSteps,
                                          extension.empty() ? "" : extension.c_str() + 1, properties)
                   : assimp->import_file(source.name.c_str(), kSteps, nullptr, properties);
  if (scene == nullptr) {
    if (assimp->is_supported(extension.c_str()) == 0)
      return fail("expected OFF, OBJ, PLY, STL, XYZ, glTF, FBX, Collada or what else assimp reads; found " +
                  (extension.empty() ? "a name without an extension" : "`" + extension + "`"));
    const char* const reason = assimp->error();
    return fail("expected a mesh in a format that assimp reads; it says: " +
                std::string(reason == nullptr || *reason == '\0' ? "no reason" : reason));
  }
  bool coloured = true;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) coloured = coloured && scene->mMeshes[i]->HasVertexColors(0);
  Polygons polygons;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    if (auto read = append(*scene->mMeshes[i], coloured, polygons); !read) return tl::unexpected(read.error());
  return triangulated(std::move(polygons), {}, {});
}

/// Lets the child have so much more memory than its parent, and so much time, that only a broken file needs more.
void limit_resources() {
  const auto limit = [](int what, rlim_t most) {
    const rlimit value{most, most};
    (void)setrlimit(static_cast<__rlimit_resource>(what), &value);
  };
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, 600);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
  unsigned long long pages = 0;
  if (std::FILE* const file = std::fopen("/proc/self/statm", "r"); file != nullptr) {
    const bool read = std::fscanf(file, "%llu", &pages) == 1;
    std::fclose(file);
    constexpr rlim_t kMore = rlim_t{8} << 30U;
    if (read) limit(RLIMIT_AS, pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + kMore);
  }
#endif
}

void write_all(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(pipe, bytes.data(), bytes.size());
    if (written <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

constexpr char kMesh = 'M';   // what follows is a PLY file
constexpr char kError = 'E';  // what follows is a message

/// What the child does. Never returns.
[[noreturn]] void run_child(const Source& source, int pipe) {
  limit_resources();
  // A library that aborts says so on stderr; the parent says it better.
  if (const int null = open("/dev/null", O_RDWR); null >= 0) {
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
  }
  // Back to what they do without a program's handlers: end this process.
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGPIPE}) std::signal(signal, SIG_DFL);
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C is for the parent, which stops this
  std::string message;
  try {
    const auto mesh = import(source);
    if (mesh) {
      write_all(pipe, std::string_view(&kMesh, 1));
      write_all(pipe, *encode_mesh(*mesh, MeshFormat::Ply));
      _exit(0);
    }
    message = mesh.error().message;
  } catch (const std::exception& error) {
    message = "assimp failed: " + std::string(error.what());
  } catch (...) {
    message = "assimp failed";
  }
  write_all(pipe, kError + message);
  _exit(0);
}

/// Reads until the other end is closed; false when asked to stop.
bool read_all(int pipe, const Task& task, std::string& out) {
  constexpr int kPatience_ms = 50;
  std::string chunk(1U << 18U, '\0');
  for (;;) {
    if (task.stopped()) return false;
    pollfd waiting{.fd = pipe, .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, kPatience_ms) <= 0) {
      task.report("reading", 0);
      continue;
    }
    const ssize_t got = read(pipe, chunk.data(), chunk.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return true;
    out.append(chunk, 0, static_cast<std::size_t>(got));
  }
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

Expected<Mesh> import_apart(const Source& source, const Task& task) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return fail(source.name + ": cannot be read: " + std::generic_category().message(errno));
  const pid_t child = fork();
  if (child < 0) {
    const int error = errno;
    close(ends[0]);
    close(ends[1]);
    return fail(source.name + ": cannot be read: " + std::generic_category().message(error));
  }
  if (child == 0) run_child(source, ends[1]);
  close(ends[1]);
  std::string answer;
  const bool complete = read_all(ends[0], task, answer);
  close(ends[0]);
  if (!complete) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!complete) return cancelled();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty())
    return fail(source.name + ": expected a mesh in a format that assimp reads; assimp crashed on it");
  const std::string_view content = std::string_view(answer).substr(1);
  if (answer[0] == kError) return fail(source.name + ": " + one_line(std::string(content)));
  return parse_mesh(content, MeshFormat::Ply, source.name, task);
}

}  // namespace

Expected<Mesh> read_by_assimp(const std::filesystem::path& path, const Task& task) {
  if (auto readable = check_readable(path); !readable) return tl::unexpected(readable.error());
  return import_apart({.name = path.string()}, task);
}

Expected<Mesh> parse_by_assimp(std::string_view bytes, std::string_view name, const Task& task) {
  return import_apart({.name = std::string(name), .bytes = bytes}, task);
}

}  // namespace armature::sdk
