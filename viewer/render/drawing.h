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
  /// Room for them; `piece()` is what is to be sent there.
  template <class Record>
  Records(const std::vector<Record>& records, std::initializer_list<RecordMember> members, bool instanced)
      : Records({records.data(), records.size(), sizeof(Record)}, members, instanced) {}

  /// Room for another member of every record, in a buffer of its own; `replace_colours()` fills it.
  void add_colours(GLuint index);
  void replace_colours(const void* colours, std::size_t bytes);

  ///@{
  /// Where records and colours go.
  [[nodiscard]] GLuint buffer() const noexcept { return buffer_.get(); }
  [[nodiscard]] GLuint colours() const noexcept { return colours_.get(); }
  ///@}
  [[nodiscard]] GLsizei count() const noexcept { return count_; }
  void bind() const { glBindVertexArray(array_.get()); }
  /// The same, for instances from that one on.
  void bind_from(GLint first) const;

 private:
  struct Bytes {
    const void* data;
    std::size_t count, size;
  };
  Records(const Bytes& bytes, std::initializer_list<RecordMember> members, bool instanced);

  GlVertexArray array_;
  GlBuffer buffer_, colours_;
  void point_at(GLint first) const;

  GLsizei count_ = 0, stride_ = 0;
  std::vector<RecordMember> members_;
  bool instanced_ = false;
};

/// A scene on the card, drawn as often as one likes. Made, used and deleted while its context is current.
class Drawing {
 public:
  /// The scene may go afterwards.
  explicit Drawing(const Scene& scene) : Drawing(scene, InBits()) {
    while (!send_some()) {
    }
  }
  ///@{
  /// The same bit by bit, for a caller with something else to do in between: nothing of it may be drawn until
  /// `send_some()` says that all of it is there, and the scene must stay so long.
  struct InBits {};
  Drawing(const Scene& scene, InBits);
  bool send_some();
  ///@}

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
  /// What a buffer is still to get.
  struct Piece {
    GLuint buffer = 0;
    std::span<const std::byte> bytes = {};
    std::size_t sent = 0;
  };
  template <class Record>
  void plan(GLuint buffer, const std::vector<Record>& records) {
    if (!records.empty()) pieces_.push_back({buffer, std::as_bytes(std::span(records))});
  }

  sdk::Sphere frame_;
  Palette palette_;
  std::array<Content, 2> layers_;  // by Layer
  std::vector<Piece> pieces_;
};

}  // namespace armature::viewer
