#include "viewer/render/drawing.h"

#include <algorithm>
#include <cassert>

namespace armature::viewer {
namespace {

/// What is sent at once: a few milliseconds.
constexpr std::size_t kBytesAStep = std::size_t{1} << 22;

}  // namespace

Records::Records(const Bytes& bytes, std::initializer_list<RecordMember> members, bool instanced)
    : count_(static_cast<GLsizei>(bytes.count)) {
  if (bytes.count == 0) return;
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  array_ = GlVertexArray(name);
  glBindVertexArray(name);
  glGenBuffers(1, &name);
  buffer_ = GlBuffer(name);
  glBindBuffer(GL_ARRAY_BUFFER, name);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes.count * bytes.size), nullptr, GL_STATIC_DRAW);
  stride_ = static_cast<GLsizei>(bytes.size);
  members_ = members;
  instanced_ = instanced;
  point_at(0);
}

/// Lets the members be those of the records from that one on.
void Records::point_at(GLint first) const {
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
  GLuint index = 0;
  for (const RecordMember& member : members_) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset into the buffer, as OpenGL has it.
    const auto* offset = reinterpret_cast<const void*>(member.offset + static_cast<std::size_t>(first) *
                                                                           static_cast<std::size_t>(stride_));
    if (member.integer) {
      glVertexAttribIPointer(index, member.components, member.type, stride_, offset);
    } else {
      const bool is_colour = member.type == GL_UNSIGNED_BYTE;
      glVertexAttribPointer(index, member.components, member.type, is_colour ? GL_TRUE : GL_FALSE, stride_, offset);
    }
    if (instanced_) glVertexAttribDivisor(index, 1);
    glEnableVertexAttribArray(index++);
  }
}

void Records::bind_from(GLint first) const {
  bind();
  point_at(first);
}

void Records::add_colours(GLuint index) {
  if (count_ == 0) return;
  glBindVertexArray(array_.get());
  GLuint name = 0;
  glGenBuffers(1, &name);
  colours_ = GlBuffer(name);
  glBindBuffer(GL_ARRAY_BUFFER, name);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count_) * static_cast<GLsizeiptr>(sizeof(sdk::Colour)), nullptr,
               GL_DYNAMIC_DRAW);
  glVertexAttribPointer(index, 3, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(sdk::Colour), nullptr);
  glEnableVertexAttribArray(index);
}

void Records::replace_colours(const void* colours, std::size_t bytes) {
  assert(bytes == static_cast<std::size_t>(count_) * sizeof(sdk::Colour));
  if (count_ == 0) return;
  glBindBuffer(GL_ARRAY_BUFFER, colours_.get());
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(bytes), colours);
}

void Drawing::recolour(Layer layer, std::span<const std::array<sdk::Colour, 3>> colours) {
  layers_[static_cast<std::size_t>(layer)].corners.replace_colours(colours.data(), colours.size_bytes());
}

Drawing::Drawing(const Scene& scene, InBits) : frame_(scene.frame()), palette_(scene.palette()) {
  for (const Layer layer : {Layer::Solid, Layer::Glass}) {
    const Scene::Content& from = scene.content(layer);
    Content& to = layers_[static_cast<std::size_t>(layer)];
    to.corners = Records(from.corners,
                         {{3, GL_FLOAT, offsetof(Scene::Corner, position)},
                          {3, GL_FLOAT, offsetof(Scene::Corner, normal)},
                          {1, GL_UNSIGNED_INT, offsetof(Scene::Corner, flags), true}},
                         false);
    to.corners.add_colours(3);
    to.balls = Records(
        from.balls,
        {{4, GL_FLOAT, offsetof(Scene::Ball, sphere)}, {3, GL_UNSIGNED_BYTE, offsetof(Scene::Ball, colour)}}, true);
    to.cones = Records(from.cones,
                       {{4, GL_FLOAT, offsetof(Scene::Cone, a)},
                        {4, GL_FLOAT, offsetof(Scene::Cone, b)},
                        {3, GL_UNSIGNED_BYTE, offsetof(Scene::Cone, colour)}},
                       true);
    plan(to.corners.buffer(), from.corners);
    plan(to.corners.colours(), from.colours);
    plan(to.balls.buffer(), from.balls);
    plan(to.cones.buffer(), from.cones);
  }
}

bool Drawing::send_some() {
  if (pieces_.empty()) return true;
  Piece& piece = pieces_.back();
  const std::size_t bytes = std::min(kBytesAStep, piece.bytes.size() - piece.sent);
  glBindBuffer(GL_ARRAY_BUFFER, piece.buffer);
  glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(piece.sent), static_cast<GLsizeiptr>(bytes),
                  piece.bytes.data() + piece.sent);
  piece.sent += bytes;
  if (piece.sent == piece.bytes.size()) pieces_.pop_back();
  return pieces_.empty();
}

}  // namespace armature::viewer
