#include "render/volume_pass.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr std::size_t kMostLights = 4;

/// One triangle that covers the viewport, from gl_VertexID alone.
constexpr char kVertexShader[] = R"glsl(
void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
  gl_Position = vec4(corner, 0.0, 1.0);
}
)glsl";

constexpr char kFragmentShader[] = R"glsl(
uniform sampler2D pixels, depths;
uniform ivec2 origin;    // of the viewport
uniform vec2 depth_row;  // clip_from_camera[2][2] and [3][2]
out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - origin;
  result = texelFetch(pixels, at, 0);
  if (result.a == 0.0) discard;
  float depth = texelFetch(depths, at, 0).r;
  gl_FragDepth = clamp(0.5 - 0.5 * depth_row.x + 0.5 * depth_row.y / depth, 0.0, 1.0);
}
)glsl";

glm::mat4 camera_from_world_of(const Camera& camera) {
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(glm::mat3(camera.world_from_camera)));
  glm::dmat4 matrix(rotation);
  matrix[3] = glm::dvec4(-(rotation * glm::dvec3(camera.world_from_camera[3])), 1);
  return glm::mat4(matrix);
}

/// Nothing, or a vector of unit length.
glm::vec3 unit(const glm::vec3& v) {
  const float length = std::sqrt(glm::dot(v, v));
  return length > 0 && std::isfinite(length) ? v / length : glm::vec3(0);
}

VolumeLight in_camera(const Light& light, const glm::mat4& camera_from_world) {
  VolumeLight result;
  const glm::vec3 direction = unit(glm::mat3(camera_from_world) * light.direction);
  result.directional = light.kind == Light::Kind::directional;
  result.place = result.directional ? -direction : glm::vec3(camera_from_world * glm::vec4(light.location, 1));
  result.color = light.color * light.intensity;
  result.ambient = light.intensity > 0 ? light.ambient_intensity / light.intensity : 0.0f;
  result.attenuation = light.attenuation;
  result.radius = light.radius;
  if (light.kind == Light::Kind::spot) {
    result.direction = direction;
    result.beam_width = light.beam_width;
    result.cut_off_angle = light.cut_off_angle;
  }
  return result;
}

/// How bright a point or spot light is there, about.
float strength_at(const VolumeLight& light, const glm::vec3& place) {
  const float distance = glm::distance(light.place, place);
  const glm::vec3& a = light.attenuation;
  return std::max({light.color.r, light.color.g, light.color.b}) /
         std::max(a.x + a.y * distance + a.z * distance * distance, 1.0f);
}

}  // namespace

std::vector<VolumeLight> volume_lights(const RenderList& list, const SplatItem& item,
                                       const glm::mat4& camera_from_world, const glm::vec3& center, bool headlight) {
  std::vector<VolumeLight> lights, local;
  for (const std::uint16_t i : item.directional_lights)
    if (i < list.lights.size()) lights.push_back(in_camera(list.lights[i], camera_from_world));
  for (const Light& light : list.lights)
    if (light.kind != Light::Kind::directional) local.push_back(in_camera(light, camera_from_world));
  std::stable_sort(local.begin(), local.end(), [&](const VolumeLight& a, const VolumeLight& b) {
    return strength_at(a, center) > strength_at(b, center);
  });
  lights.insert(lights.end(), local.begin(), local.end());
  if (lights.size() > kMostLights) lights.resize(kMostLights);
  if (headlight) lights.push_back(volume_headlight().front());
  // No lights at all would mean the viewer's.
  if (lights.empty()) lights.push_back({.color = glm::vec3(0)});
  return lights;
}

VolumePass::VolumePass(const Gl& gl)
    : gl_(gl), no_attributes_(make_vertex_array(gl)), pixels_(make_texture(gl)), depths_(make_texture(gl)) {
  for (const Texture* texture : {&pixels_, &depths_}) {
    gl.BindTexture(GL_TEXTURE_2D, texture->name());
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  }
  auto made = make_program(gl, "", kVertexShader, kFragmentShader);
  auto* program = std::get_if<Program>(&made);
  if (!program) return;
  program_ = std::move(*program);
  pixels_at_ = gl.GetUniformLocation(program_.name(), "pixels");
  depths_at_ = gl.GetUniformLocation(program_.name(), "depths");
  origin_at_ = gl.GetUniformLocation(program_.name(), "origin");
  depth_row_at_ = gl.GetUniformLocation(program_.name(), "depth_row");
}

const VolumeModel& VolumePass::model_of(const std::shared_ptr<const qnv::Cloud>& cloud) {
  const auto [found, fresh] = models_.try_emplace(cloud.get());
  if (fresh) found->second = {cloud, volume_model(*cloud)};
  return found->second.model;
}

void VolumePass::lay_over(const VolumeLayer& layer, const glm::mat4& clip_from_camera, const DrawOptions& options) {
  const auto upload = [&](const Texture& texture, GLenum unit, GLint internal, GLenum format, GLenum type,
                          const void* data) {
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.BindSampler(unit, 0);
    gl_.BindTexture(GL_TEXTURE_2D, texture.name());
    gl_.TexImage2D(GL_TEXTURE_2D, 0, internal, layer.width, layer.height, 0, format, type, data);
  };
  upload(pixels_, 0, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, layer.pixels.data());
  upload(depths_, 1, GL_R32F, GL_RED, GL_FLOAT, layer.depth.data());
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.UseProgram(program_.name());
  gl_.Uniform1i(pixels_at_, 0);
  gl_.Uniform1i(depths_at_, 1);
  gl_.Uniform2i(origin_at_, options.x, options.y);
  gl_.Uniform2f(depth_row_at_, clip_from_camera[2][2], clip_from_camera[3][2]);
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void VolumePass::draw(const RenderList& list, const Camera& camera, const glm::mat4& clip_from_camera,
                      const DrawOptions& options, FrameStatistics& statistics) {
  std::erase_if(models_, [](const auto& entry) { return entry.second.cloud.expired(); });
  struct Volume {
    const SplatItem* item;
    glm::mat4 camera_from_node;
    glm::vec3 center;  // camera space
  };
  std::vector<Volume> volumes;
  const glm::mat4 camera_from_world = camera_from_world_of(camera);
  for (const SplatItem& item : list.splats) {
    if (!item.cloud || item.cloud->description.kind != qnv::Kind::volume || item.cloud->empty()) continue;
    const qnv::Box& box = item.cloud->description.box;
    const glm::mat4 camera_from_node(glm::dmat4(camera_from_world) * glm::dmat4(item.world_from_node));
    const glm::vec3 middle = box.empty() ? item.cloud->positions.front() : (box.lower + box.upper) * 0.5f;
    volumes.push_back({&item, camera_from_node, glm::vec3(camera_from_node * glm::vec4(middle, 1))});
  }
  if (volumes.empty() || !program_) return;
  // By keys that are numbers, so that the order is one.
  const auto distance = [](const Volume& v) { return std::isfinite(v.center.z) ? -v.center.z : 0.0f; };
  std::stable_sort(volumes.begin(), volumes.end(),
                   [&](const Volume& a, const Volume& b) { return distance(a) > distance(b); });
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LEQUAL);
  gl_.DepthMask(GL_FALSE);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  SplatView view;
  view.tangents = {1 / clip_from_camera[0][0], 1 / clip_from_camera[1][1]};
  view.width = options.width;
  view.height = options.height;
  view.near_plane = camera.near_plane;
  for (const Volume& volume : volumes) {
    view.camera_from_node = volume.camera_from_node;
    const std::vector<VolumeLight> lights =
        volume_lights(list, *volume.item, camera_from_world, volume.center, options.headlight);
    VolumeOptions look;
    look.opacity = settings.opacity * (1 - volume.item->material.transparency);
    look.least_magnitude = settings.least_magnitude;
    if (settings.clip) look.clip = *settings.clip * volume.item->world_from_node;
    look.lights = lights;
    const VolumeLayer layer = rasterize_volume(*volume.item->cloud, model_of(volume.item->cloud), view, look);
    statistics.vectors += layer.vectors;
    statistics.splats = "cpu";
    if (layer.empty()) continue;
    lay_over(layer, clip_from_camera, options);
    ++statistics.draw_calls;
  }
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
}

}  // namespace gs::render
