#include "viewer/render/drawing.h"

namespace armature::viewer {

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
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes.count * bytes.size), bytes.data, GL_STATIC_DRAW);
  GLuint index = 0;
  const auto stride = static_cast<GLsizei>(bytes.size);
  for (const RecordMember& member : members) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset into the buffer, as OpenGL has it.
    const auto* offset = reinterpret_cast<const void*>(member.offset);
    if (member.integer) {
      glVertexAttribIPointer(index, member.components, member.type, stride, offset);
    } else {
      const bool is_colour = member.type == GL_UNSIGNED_BYTE;
      glVertexAttribPointer(index, member.components, member.type, is_colour ? GL_TRUE : GL_FALSE, stride, offset);
    }
    if (instanced) glVertexAttribDivisor(index, 1);
    glEnableVertexAttribArray(index++);
  }
}

Drawing::Drawing(const Scene& scene) : frame_(scene.frame()), palette_(scene.palette()) {
  for (const Layer layer : {Layer::Solid, Layer::Glass}) {
    const Scene::Content& from = scene.content(layer);
    Content& to = layers_[static_cast<std::size_t>(layer)];
    to.corners = Records(from.corners,
                         {{3, GL_FLOAT, offsetof(Scene::Corner, position)},
                          {3, GL_FLOAT, offsetof(Scene::Corner, normal)},
                          {3, GL_UNSIGNED_BYTE, offsetof(Scene::Corner, colour)},
                          {1, GL_UNSIGNED_BYTE, offsetof(Scene::Corner, flags), true}},
                         false);
    to.balls = Records(
        from.balls,
        {{4, GL_FLOAT, offsetof(Scene::Ball, sphere)}, {3, GL_UNSIGNED_BYTE, offsetof(Scene::Ball, colour)}}, true);
    to.cones = Records(from.cones,
                       {{4, GL_FLOAT, offsetof(Scene::Cone, a)},
                        {4, GL_FLOAT, offsetof(Scene::Cone, b)},
                        {3, GL_UNSIGNED_BYTE, offsetof(Scene::Cone, colour)}},
                       true);
  }
}

}  // namespace armature::viewer
