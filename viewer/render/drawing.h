#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

#include "viewer/render/gl_objects.h"
#include "viewer/scene/scene.h"

namespace armature::viewer {

/// One member of a record of vertices or instances, as the vertex stage takes it in.
struct RecordMember {
  GLint components;
  GLenum type;
  std::size_t offset;
  bool integer = false;
};

/// Records of one kind on the card.
class Records {
 public:
  Records() = default;
  template <class Record>
  Records(const std::vector<Record>& records, std::initializer_list<RecordMember> members, bool instanced)
      : Records({records.data(), records.size(), sizeof(Record)}, members, instanced) {}

  /// Another member of every record, in a buffer of its own; `replace_colours()` replaces it.
  void add_colours(std::span<const sdk::Colour> colours, GLuint index);
  void replace_colours(const void* colours, std::size_t bytes);

  [[nodiscard]] GLsizei count() const noexcept { return count_; }
  void bind() const { glBindVertexArray(array_.get()); }

 private:
  struct Bytes {
    const void* data;
    std::size_t count, size;
  };
  Records(const Bytes& bytes, std::initializer_list<RecordMember> members, bool instanced);

  GlVertexArray array_;
  GlBuffer buffer_, colours_;
  GLsizei count_ = 0;
};

/// A scene on the card, drawn as often as one likes. Made, used and deleted while its context is current.
class Drawing {
 public:
  /// The scene may go afterwards.
  explicit Drawing(const Scene& scene);

  struct Content {
    Records corners, balls, cones;
    [[nodiscard]] bool empty() const noexcept {
      return corners.count() == 0 && balls.count() == 0 && cones.count() == 0;
    }
  };
  /// Other colours for the corners of a layer that holds one mesh alone, by FaceId; nothing else is sent to the card.
  void recolour(Layer layer, std::span<const std::array<sdk::Colour, 3>> colours);
  [[nodiscard]] const Content& content(Layer layer) const noexcept { return layers_[static_cast<std::size_t>(layer)]; }
  [[nodiscard]] const sdk::Sphere& frame() const noexcept { return frame_; }
  [[nodiscard]] const Palette& palette() const noexcept { return palette_; }

 private:
  sdk::Sphere frame_;
  Palette palette_;
  std::array<Content, 2> layers_;  // by Layer
};

}  // namespace armature::viewer
