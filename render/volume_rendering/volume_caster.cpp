#include "render/volume_rendering/volume_caster.h"

#include "render/gl/shaders.h"
#include "render/scene/fog.h"
#include "render/volume_rendering/ray_shaders.h"
#include "render/volume_rendering/volume_source.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr GLuint kDepthUnit = 0, kFirstUnit = 1;
constexpr GLuint kMaxUnits = 16;  // OpenGL guarantees so many
constexpr std::size_t kMostShaders = 64;
constexpr int kBand = 48;  // rows of pixels between two calls of `go_on`
constexpr std::string_view kLightDefines = "#define LOCAL_LIGHTS\n#define SPECULAR\n#define LIT\n";

/// Returns the matrix from box coordinates, 0 to 1, to the box from -0.5 to 0.5 of an item.
glm::dmat4 unit_from_box() { return glm::translate(glm::dmat4(1), glm::dvec3(-0.5)); }

}  // namespace

VolumeCaster::VolumeCaster(const Gl& gl) : gl_(gl), textures_(gl), lights_(gl), no_attributes_(make_vertex_array(gl)) {}

void VolumeCaster::begin(const View& view, std::vector<Cast>& casts) {
  view_ = view;
  depths_copied_ = false;
  textures_.forget_unused();
  std::erase_if(prepared_, [](const auto& entry) { return entry.second.look.expired(); });
  if (shaders_.size() > kMostShaders) shaders_.clear();  // events can request any number of combinations
  if (casts.empty()) return;
  std::stable_sort(casts.begin(), casts.end(), [](const Cast& a, const Cast& b) { return a.depth > b.depth; });
  lights_.begin(view.list->lights, view.viewer_from_world, *view.options);
  for (Cast& cast : casts) cast.lights = lights_.choose(cast.item->directional_lights, cast.center, cast.radius);
  lights_.upload();
}

VolumeCaster::Prepared& VolumeCaster::prepare(const std::shared_ptr<const VolumeLook>& look,
                                              const VoxelTextures::Volume& volume) {
  Prepared& entry = prepared_[look.get()];
  if (!entry.look.expired() && entry.version == volume.version) return entry;
  entry = {};
  entry.look = look;
  entry.version = volume.version;
  VolumeSource source = volume_source(*look);
  entry.defines = std::move(source.defines);
  entry.code = std::move(source.code);
  entry.lit = source.lights;
  const std::vector<std::uint8_t> blocks = occupied_blocks(volume.ranges, *look);
  // Rays that test blocks pay off only if there are empty ones.
  if (std::find(blocks.begin(), blocks.end(), 0) != blocks.end()) {
    entry.blocks = textures_.block_texture(blocks, volume.ranges.blocks);
    entry.block_size = volume.ranges.blocks;
    entry.defines += "#define BLOCKS\n";
  }
  return entry;
}

VolumeCaster::Shader* VolumeCaster::shader_of(const Prepared& prepared, bool fog) {
  std::string defines = prepared.defines, fragment;
  if (prepared.lit) {
    defines.append(kLightDefines).append(LightSets::defines(LightSets::kLoop));
    fragment += kLightingShader;
  }
  if (fog) {
    defines += "#define FOG\n";
    fragment += kFogShader;
  }
  fragment.append(kVolumeRayInputs).append(prepared.code).append(kVolumeRayMain);
  const auto [found, fresh] = shaders_.try_emplace(defines + fragment);
  Shader& shader = found->second;
  if (fresh) {
    auto made = make_program(gl_, defines, kVolumeBoxVertexShader, fragment);
    if (auto* error = std::get_if<ContextError>(&made)) {
      last_error_ = std::move(error->message);
    } else {
      shader.program = std::move(std::get<Program>(made));
      shader.lights = LightUniforms(gl_, shader.program.name());
      shader.fog = FogUniforms(gl_, shader.program.name());
    }
  }
  return shader.program ? &shader : nullptr;
}

GLint VolumeCaster::place(Shader& shader, const std::string& name) {
  const auto [found, fresh] = shader.places.try_emplace(name, -1);
  if (fresh) found->second = gl_.GetUniformLocation(shader.program.name(), name.c_str());
  return found->second;
}

/// Binds a texture to the next unit, if the program uses it.
void VolumeCaster::bind(Shader& shader, const std::string& name, GLenum target, GLuint texture) {
  const GLint location = place(shader, name);
  if (location < 0 || next_unit_ >= kMaxUnits) return;
  gl_.ActiveTexture(GL_TEXTURE0 + next_unit_);
  gl_.BindSampler(next_unit_, 0);
  gl_.BindTexture(target, texture);
  gl_.Uniform1i(location, static_cast<GLint>(next_unit_));
  ++next_unit_;
}

/// Sets the values and textures of the styles.
void VolumeCaster::bind_steps(Shader& shader, const VolumeLook& look) {
  const std::vector<const VolumeStep*> steps = numbered_steps(look);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const VolumeStep& step = *steps[i];
    const std::string number = std::to_string(i);
    if (!step.values.empty())
      gl_.Uniform4fv(place(shader, "values_" + number), static_cast<GLsizei>(step.values.size()),
                     glm::value_ptr(step.values[0]));
    if (step.normals)
      bind(shader, "normals_" + number, GL_TEXTURE_3D, textures_.volume(step.normals, false).values.name());
    for (std::size_t k = 0; k < step.tables.size(); ++k)
      if (const auto& table = step.tables[k])
        bind(shader, "table_" + number + "_" + std::to_string(k), table->slices > 1 ? GL_TEXTURE_3D : GL_TEXTURE_2D,
             textures_.table(table));
    if (!step.voxels) continue;
    const VoxelTextures::Volume& second = textures_.volume(step.voxels, needs_gradients(step));
    bind(shader, "voxels_" + number, GL_TEXTURE_3D, second.values.name());
    bind(shader, "gradients_" + number, GL_TEXTURE_3D, second.gradients.name());
  }
}

void VolumeCaster::set_volume(Shader& shader, const DrawItem& item, const VoxelTextures::Volume& volume) {
  const VolumeLook& look = *item.volume;
  const glm::dmat4 viewer_from_box = view_.viewer_from_world * item.world_from_node * unit_from_box();
  viewer_from_box_ = glm::mat4(viewer_from_box);
  gl_.UniformMatrix4fv(place(shader, "viewer_from_box"), 1, GL_FALSE, glm::value_ptr(viewer_from_box_));
  const Projection& lens = view_.projection;
  gl_.UniformMatrix4fv(place(shader, "clip_from_viewer"), 1, GL_FALSE, glm::value_ptr(lens.clip_from_viewer));
  gl_.Uniform1f(place(shader, "camera_back"), lens.back);
  if (const GLint eye_back = place(shader, "eye_back"); eye_back >= 0) gl_.Uniform1f(eye_back, lens.back);
  const glm::dmat4 box_from_viewer = glm::inverse(viewer_from_box);
  const glm::vec3 eye(box_from_viewer * glm::dvec4(0, 0, lens.back, 1));
  gl_.Uniform3fv(place(shader, "eye"), 1, glm::value_ptr(eye));
  gl_.Uniform2f(place(shader, "depth_of"), lens.depth_offset, lens.depth_scale);
  gl_.Uniform1f(place(shader, "near_depth"), view_.near_plane);
  // In windows, software drivers take fewer samples.
  gl_.Uniform1f(place(shader, "rate"), gl_.software && view_.options->go_on ? 1.0f : 2.0f);
  const glm::vec3 count(volume.size[0], volume.size[1], volume.size[2]);
  gl_.Uniform3fv(place(shader, "voxel_count"), 1, glm::value_ptr(count));
  gl_.Uniform3fv(place(shader, "dimensions"), 1, glm::value_ptr(look.dimensions));
  const glm::dvec3 voxel = glm::dvec3(look.dimensions) / glm::dvec3(count);
  gl_.Uniform1f(place(shader, "voxel_length"), static_cast<float>(std::cbrt(voxel.x * voxel.y * voxel.z)));
  gl_.Uniform1f(place(shader, "threshold"), look.threshold);
  // Normals transform by the inverse transposed matrix. Gradients of box coordinates are those of voxels, times their
  // number. The surface normal points to smaller values.
  const glm::dmat3 normal_from_box = glm::transpose(glm::dmat3(box_from_viewer));
  const glm::dmat3 by_count(count.x, 0, 0, 0, count.y, 0, 0, 0, count.z);
  const glm::dvec3& d = look.dimensions;
  const glm::dmat3 by_size(d.x, 0, 0, 0, d.y, 0, 0, 0, d.z);
  const auto scaled = [](const glm::dmat3& m) {
    double largest = 0;
    for (int i = 0; i < 3; ++i) largest = std::max(largest, glm::length(m[i]));
    return glm::mat3(largest > 0 ? m / largest : m);
  };
  const glm::mat3 from_gradient = scaled(-(normal_from_box * by_count)), from_local = scaled(normal_from_box * by_size);
  gl_.UniformMatrix3fv(place(shader, "normal_from_gradient"), 1, GL_FALSE, glm::value_ptr(from_gradient));
  gl_.UniformMatrix3fv(place(shader, "normal_from_local"), 1, GL_FALSE, glm::value_ptr(from_local));
  const glm::mat3 directions(box_from_viewer);
  gl_.UniformMatrix3fv(place(shader, "box_from_viewer"), 1, GL_FALSE, glm::value_ptr(directions));
  std::array<GLint, VolumeLook::kSegments / 32> hidden{};
  std::transform(look.hidden_segments.begin(), look.hidden_segments.end(), hidden.begin(),
                 [](std::uint32_t bits) { return static_cast<GLint>(bits); });
  if (look.segments)
    gl_.Uniform1iv(place(shader, "hidden_segments"), static_cast<GLsizei>(hidden.size()), hidden.data());
  if (!look.iso_surfaces) return;
  gl_.Uniform1f(place(shader, "least_gradient"), look.least_gradient);
  for (std::size_t i = 0; i < look.surfaces.size(); ++i) {
    const std::string number = "[" + std::to_string(i) + "]";
    gl_.Uniform1f(place(shader, "surfaces" + number), look.surfaces[i]);
    gl_.Uniform1i(place(shader, "surface_chains" + number), static_cast<GLint>(look.surface_chains[i]));
  }
}

void VolumeCaster::set_clip_planes(Shader& shader, const DrawItem& item) {
  std::array<glm::vec4, kMaxClipPlanes> planes{};
  std::size_t count = 0;
  const glm::dmat4 world_from_box = item.world_from_node * unit_from_box();
  for (const std::uint16_t plane : item.clip_planes)
    if (count < planes.size() && plane < view_.list->clip_planes.size())
      planes[count++] = glm::vec4(view_.list->clip_planes[plane] * world_from_box);
  gl_.Uniform1i(place(shader, "clip_plane_count"), static_cast<GLint>(count));
  gl_.Uniform4fv(place(shader, "clip_planes"), static_cast<GLsizei>(planes.size()), glm::value_ptr(planes[0]));
}

bool VolumeCaster::make_depths(GLenum format, int width, int height) {
  if (depth_target_ && depth_format_ == format && depth_width_ >= width && depth_height_ >= height) return true;
  depth_target_ = {};
  depth_format_ = format;
  depth_width_ = std::max(depth_width_, width);
  depth_height_ = std::max(depth_height_, height);
  const bool stencil = format == GL_DEPTH24_STENCIL8 || format == GL_DEPTH32F_STENCIL8;
  depths_ = make_texture(gl_);
  depth_target_ = make_framebuffer(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, depths_.name());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl_.TexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), depth_width_, depth_height_, 0,
                 stencil ? GL_DEPTH_STENCIL : GL_DEPTH_COMPONENT,
                 format == GL_DEPTH32F_STENCIL8  ? GL_FLOAT_32_UNSIGNED_INT_24_8_REV
                 : format == GL_DEPTH24_STENCIL8 ? GL_UNSIGNED_INT_24_8
                                                 : GL_FLOAT,
                 nullptr);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, depth_target_.name());
  gl_.FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT,
                           GL_TEXTURE_2D, depths_.name(), 0);
  const GLenum none = GL_NONE;
  gl_.DrawBuffers(1, &none);
  return gl_.CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && !take_errors(gl_);
}

/// Copies the depth of the opaque objects to a texture, once a frame. Tries the formats that targets may have, because
/// a blit needs equal formats.
bool VolumeCaster::copy_depths() {
  if (depths_copied_) return true;
  GLint drawn = 0, read = 0;
  gl_.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
  gl_.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
  const DrawOptions& options = *view_.options;
  const int right = options.x + options.width, top = options.y + options.height;
  take_errors(gl_);
  std::array<GLenum, 5> formats = {depth_format_, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24, GL_DEPTH24_STENCIL8,
                                   GL_DEPTH32F_STENCIL8};
  for (const GLenum format : formats) {
    if (format == 0) continue;
    const bool made = make_depths(format, right, top);
    if (made) {
      gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(drawn));
      gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, depth_target_.name());
      gl_.BlitFramebuffer(options.x, options.y, right, top, options.x, options.y, right, top, GL_DEPTH_BUFFER_BIT,
                          GL_NEAREST);
      depths_copied_ = !take_errors(gl_);
    }
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(drawn));
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read));
    if (depths_copied_) break;
    depth_target_ = {};
  }
  return depths_copied_;
}

/// Draws the back faces of the box with the current program, in bands if the frame can be cancelled.
bool VolumeCaster::cast_rays() {
  constexpr GLsizei kVertices = 36;
  const DrawOptions& options = *view_.options;
  if (!options.go_on) {
    gl_.DrawArrays(GL_TRIANGLES, 0, kVertices);
    return true;
  }
  bool good = true;
  for (int row = 0; row < options.height && good; row += kBand) {
    gl_.Scissor(options.x, options.y + row, options.width, std::min(kBand, options.height - row));
    gl_.DrawArrays(GL_TRIANGLES, 0, kVertices);
    if (gl_.software) gl_.Finish();
    good = options.go_on();
  }
  gl_.Scissor(options.x, options.y, options.width, options.height);
  return good;
}

bool VolumeCaster::draw(const Cast& cast) {
  const DrawItem& item = *cast.item;
  const std::shared_ptr<const VolumeLook>& look = item.volume;
  if (!look->voxels) return true;
  const VoxelTextures::Volume& volume = textures_.volume(look->voxels, needs_gradients(*look));
  if (!volume.values || (look->iso_surfaces && look->surfaces.empty())) return true;
  Prepared& prepared = prepare(look, volume);
  const CameraFog fog = camera_fog(
      item.local_fog < view_.list->local_fogs.size() ? view_.list->local_fogs[item.local_fog] : view_.list->fog,
      view_.world_from_camera);
  Shader* shader = shader_of(prepared, fog.on);
  if (!shader || !copy_depths()) return true;
  gl_.UseProgram(shader->program.name());
  next_unit_ = kDepthUnit;
  bind(*shader, "depths", GL_TEXTURE_2D, depths_.name());
  next_unit_ = kFirstUnit;
  bind(*shader, "voxels", GL_TEXTURE_3D, volume.values.name());
  const GLint filter = look->smooth ? GL_LINEAR : GL_NEAREST;
  if (next_unit_ > kFirstUnit)
    for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_.TexParameteri(GL_TEXTURE_3D, name, filter);
  bind(*shader, "gradients", GL_TEXTURE_3D,
       look->gradients ? textures_.volume(look->gradients, false).values.name() : volume.gradients.name());
  if (look->projection_colors)
    bind(*shader, "projection_colors", GL_TEXTURE_2D, textures_.table(look->projection_colors));
  if (look->segments) bind(*shader, "segments", GL_TEXTURE_3D, textures_.volume(look->segments, false).values.name());
  if (prepared.blocks) {
    bind(*shader, "blocks", GL_TEXTURE_3D, prepared.blocks.name());
    const glm::vec3 count = glm::vec3(volume.size[0], volume.size[1], volume.size[2]) / float{VoxelRanges::kBlock};
    gl_.Uniform3fv(place(*shader, "block_count"), 1, glm::value_ptr(count));
  }
  bind_steps(*shader, *look);
  gl_.ActiveTexture(GL_TEXTURE0 + kDepthUnit);
  gl_.BindTexture(GL_TEXTURE_2D, depths_.name());  // uploads of tables also use this unit
  set_volume(*shader, item, volume);
  set_clip_planes(*shader, item);
  if (prepared.lit) lights_.bind(cast.lights, shader->lights);
  if (fog.on) shader->fog.set(gl_, fog);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_FALSE);
  gl_.Enable(GL_DEPTH_CLAMP);
  gl_.Enable(GL_CULL_FACE);
  gl_.CullFace(GL_FRONT);
  gl_.FrontFace(glm::determinant(glm::mat3(viewer_from_box_)) < 0 ? GL_CW : GL_CCW);
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.BindVertexArray(no_attributes_.name());
  const bool good = cast_rays();
  gl_.Disable(GL_BLEND);
  gl_.FrontFace(GL_CCW);
  gl_.CullFace(GL_BACK);
  gl_.Disable(GL_CULL_FACE);
  gl_.Disable(GL_DEPTH_CLAMP);
  gl_.DepthMask(GL_TRUE);
  return good;
}

}  // namespace gs::render
