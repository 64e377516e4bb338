#include "render/mesh/item_styles.h"

#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gs::render {
namespace {

constexpr std::size_t kMaxStyles = 65'536;  // of one frame; DrawState::packed() stores 16 bits

/// Returns the plane in camera space. The camera is `back` metres behind the viewer.
glm::vec4 plane_in_camera(const glm::dvec4& plane, const glm::dmat4& camera_from_world) {
  const glm::dvec3 normal(plane);
  const glm::dvec3 turned = glm::dmat3(camera_from_world) * normal;
  return {glm::vec3(turned), static_cast<float>(plane.w - glm::dot(turned, glm::dvec3(camera_from_world[3])))};
}

}  // namespace

StyleUniforms::StyleUniforms(const Gl& gl, GLuint program)
    : clip_planes(gl.GetUniformLocation(program, "clip_planes")),
      point_size(gl.GetUniformLocation(program, "point_size")),
      point_attenuation(gl.GetUniformLocation(program, "point_attenuation")),
      line_pattern(gl.GetUniformLocation(program, "line_pattern")),
      hatch(gl.GetUniformLocation(program, "hatch")),
      hatch_color(gl.GetUniformLocation(program, "hatch_color")),
      pixel_side(gl.GetUniformLocation(program, "pixel_side")),
      sprite(gl.GetUniformLocation(program, "sprite")) {}

void ItemStyles::begin_frame(const Frame& frame) {
  frame_ = frame;
  bindings_.assign(1, {});
}

bool ItemStyles::has_style(const DrawItem& item) {
  return !item.clip_planes.empty() || item.style || item.local_fog != kNoLocalFog;
}

// A frame with too many styles uses the last one again.
std::uint32_t ItemStyles::number_of(const DrawItem& item, GLenum primitive) {
  constexpr std::size_t kCompared = 64;  // number of last styles that are compared
  const std::size_t first = bindings_.size() > kCompared ? bindings_.size() - kCompared : 0;
  for (std::size_t i = bindings_.size(); i-- > first;) {
    const Binding& known = bindings_[i];
    if (i > 0 && known.clip_planes.shares_with(item.clip_planes) && known.shape == item.style &&
        known.local_fog == item.local_fog && known.primitive == primitive)
      return static_cast<std::uint32_t>(i);
  }
  if (bindings_.size() >= kMaxStyles) return kMaxStyles - 1;
  Binding made;
  made.clip_planes = item.clip_planes;
  made.shape = item.style;
  made.local_fog = item.local_fog;
  made.primitive = primitive;
  made.camera_planes.fill({0, 0, 0, 1});
  for (const std::uint16_t plane : item.clip_planes)
    if (made.planes < kMaxClipPlanes && plane < frame_.list->clip_planes.size())
      made.camera_planes[made.planes++] = plane_in_camera(frame_.list->clip_planes[plane], frame_.camera_from_world);
  made.fog = item.local_fog < frame_.list->local_fogs.size()
                 ? camera_fog(frame_.list->local_fogs[item.local_fog], frame_.world_from_camera)
                 : frame_.fog;
  bindings_.push_back(std::move(made));
  return static_cast<std::uint32_t>(bindings_.size() - 1);
}

void ItemStyles::apply(std::uint32_t number, const StyleUniforms& at, const FogUniforms& fog) {
  const Binding& style = bindings_[number];
  static const ShapeStyle kUsual;
  const ShapeStyle& shape = style.shape ? *style.shape : kUsual;
  constexpr float kUsualPoint = 2;
  gl_.Uniform4fv(at.clip_planes, static_cast<GLsizei>(kMaxClipPlanes), glm::value_ptr(style.camera_planes[0]));
  const glm::vec4 size = shape.sized_points ? glm::vec4(shape.point_size, shape.smallest_point, shape.largest_point, 0)
                                            : glm::vec4(kUsualPoint, kUsualPoint, kUsualPoint, 0);
  const glm::vec4 samples = size * frame_.pixel_side;
  gl_.Uniform4fv(at.point_size, 1, glm::value_ptr(samples));
  gl_.Uniform3fv(at.point_attenuation, 1, glm::value_ptr(shape.point_attenuation));
  gl_.Uniform1i(at.line_pattern,
                style.primitive == GL_TRIANGLES ? -1 : std::bit_cast<std::int32_t>(shape.line_pattern));
  const float hatches = style.primitive != GL_TRIANGLES || !shape.hatched ? 0.0f : shape.filled ? 1.0f : 2.0f;
  const glm::vec4 color(shape.hatch_color, hatches);
  gl_.Uniform4fv(at.hatch_color, 1, glm::value_ptr(color));
  if (hatches > 0) {
    const ShapeStyle::Hatch& rows = hatch_pattern(shape.hatch_style);
    std::array<GLint, 32> bits;
    std::transform(rows.begin(), rows.end(), bits.begin(), [](std::uint32_t row) { return std::bit_cast<GLint>(row); });
    gl_.Uniform1iv(at.hatch, static_cast<GLsizei>(bits.size()), bits.data());
  }
  gl_.Uniform1f(at.pixel_side, frame_.pixel_side);
  if (at.sprite >= 0) gl_.Uniform1i(at.sprite, style.primitive == GL_POINTS ? 1 : 0);
  if (style.fog.on) fog.set(gl_, style.fog);
  gl_.LineWidth(std::max(shape.line_width, 1.0f) * frame_.pixel_side);
  gl_.Enable(GL_PROGRAM_POINT_SIZE);
  for (std::size_t i = 0; i < kMaxClipPlanes; ++i)
    (i < style.planes ? gl_.Enable : gl_.Disable)(static_cast<GLenum>(GL_CLIP_DISTANCE0 + i));
  applied_ = true;
}

void ItemStyles::end() {
  if (!applied_) return;
  applied_ = false;
  for (std::size_t i = 0; i < kMaxClipPlanes; ++i) gl_.Disable(static_cast<GLenum>(GL_CLIP_DISTANCE0 + i));
  gl_.Disable(GL_PROGRAM_POINT_SIZE);
  gl_.LineWidth(frame_.pixel_side);
}

}  // namespace gs::render
