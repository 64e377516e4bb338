#include "render/mesh_pass.h"

#include "render/shaders.h"

#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kManyTriangles = 20'000;
constexpr float kSmallTriangle = 2;                     // pixels of the mesh's disc on the screen for each triangle
constexpr float kPointSize = 2, kShininessScale = 128;  // VRML97 4.14.4
constexpr const char* kDefines[] = {"LIT",           "NORMALS", "COLORS",     "TEXTURE",      "INTENSITY",
                                    "TEXTURE_ALPHA", "CUT_OUT", "PER_VERTEX", "LOCAL_LIGHTS", "SPECULAR"};

/// The affine product in double: the difference of two large coordinates must survive.
void compose(const glm::dmat4& camera_from_world, const glm::mat4& world_from_node, float (&rows)[3][4]) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      double sum = column == 3 ? camera_from_world[3][row] : 0.0;
      for (int k = 0; k < 3; ++k) sum += camera_from_world[k][row] * double{world_from_node[column][k]};
      rows[row][column] = static_cast<float>(sum);
    }
}

struct Sphere {
  glm::vec3 center;
  float radius;  // negative: not known
};

/// Around the mesh's box, in camera space.
Sphere bounding_sphere(const vrml::Bounds& bounds, const float (&rows)[3][4]) {
  if (bounds.empty()) return {glm::vec3(rows[0][3], rows[1][3], rows[2][3]), -1};
  const glm::vec3 center = bounds.center(), half = bounds.size() * 0.5f;
  Sphere sphere{};
  float square = 0;
  for (int i = 0; i < 3; ++i) {
    const float* r = rows[i];
    sphere.center[i] = r[0] * center.x + r[1] * center.y + r[2] * center.z + r[3];
    const float extent = std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z;
    square += extent * extent;
  }
  sphere.radius = std::sqrt(square);
  return std::isfinite(sphere.radius) ? sphere : Sphere{sphere.center, -1};
}

bool mirrors(const float (&m)[3][4]) {
  const double determinant = double{m[0][0]} * (double{m[1][1]} * m[2][2] - double{m[1][2]} * m[2][1]) -
                             double{m[0][1]} * (double{m[1][0]} * m[2][2] - double{m[1][2]} * m[2][0]) +
                             double{m[0][2]} * (double{m[1][0]} * m[2][1] - double{m[1][1]} * m[2][0]);
  return determinant < 0;
}

void set(float (&to)[3], const glm::vec3& from) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

}  // namespace

std::uint64_t MeshPass::DrawState::packed() const {
  return std::uint64_t{variant} << 54 | std::uint64_t{mirrored} << 53 | std::uint64_t{cull} << 52 |
         std::uint64_t{lights} << 32 | texture;
}

std::variant<std::unique_ptr<MeshPass>, ContextError> MeshPass::create(const Gl& gl) {
  std::unique_ptr<MeshPass> pass(new MeshPass(gl));
  // The variant that nearly every world needs; the others come from the same source when they are needed.
  if (!pass->build(kLit | kNormals)) return ContextError{pass->last_error_};
  return pass;
}

MeshPass::MeshPass(const Gl& gl) : gl_(gl), meshes_(gl), textures_(gl), lights_(gl) {}

bool MeshPass::build(unsigned variant) {
  VariantProgram& entry = programs_[variant];
  if (entry.program || entry.failed) return !entry.failed;
  std::string defines;
  for (unsigned bit = 0; bit < std::size(kDefines); ++bit)
    if (variant >> bit & 1) defines.append("#define ").append(kDefines[bit]).append("\n");
  if (variant & kLit) defines += kLightingShader;
  auto made = make_program(gl_, defines, kMeshVertexShader, kMeshFragmentShader);
  if (auto* error = std::get_if<ContextError>(&made)) {
    entry.failed = true;
    last_error_ = std::move(error->message);
    return false;
  }
  entry.program = std::move(std::get<Program>(made));
  const GLuint name = entry.program.name();
  entry.clip_from_camera = gl_.GetUniformLocation(name, "clip_from_camera");
  entry.texture_transform = gl_.GetUniformLocation(name, "texture_transform");
  const GLuint block = gl_.GetUniformBlockIndex(name, "Lights");
  if (block != GL_INVALID_INDEX) gl_.UniformBlockBinding(name, block, LightSets::kBinding);
  return true;
}

std::uint32_t MeshPass::texture_number(const TextureUse& use, const TextureStore::Entry& entry) {
  const auto [first, last] = binding_numbers_.equal_range(entry.order);
  for (auto found = first; found != last; ++found) {
    const TextureBinding& binding = texture_bindings_[found->second];
    if (binding.repeat_s == use.repeat_s && binding.repeat_t == use.repeat_t && binding.transform == use.transform)
      return found->second;
  }
  const auto number = static_cast<std::uint32_t>(texture_bindings_.size());
  texture_bindings_.push_back({&entry, use.repeat_s, use.repeat_t, use.transform});
  binding_numbers_.emplace(entry.order, number);
  return number;
}

/// Whether the triangles of a lit mesh are so small on the screen, and its light so simple, that the
/// equation gives the same picture when it is evaluated at the vertices. Only done where a CPU draws:
/// llvmpipe shades sixteen pixels for every triangle, however small.
bool MeshPass::light_per_vertex(const Prepared& prepared, float depth, float radius, const View& view) const {
  const DrawState& state = prepared.state;
  const std::size_t triangles = static_cast<std::size_t>(prepared.slice->index_count) / 3;
  if (!gl_.software || triangles < kManyTriangles || radius < 0 || depth <= radius) return false;
  constexpr unsigned kDecisive = kLit | kNormals | kTexture | kLocalLights | kSpecular;
  if ((state.variant & kDecisive) != (kLit | kNormals)) return false;
  const float pixels = radius / depth * view.pixels_per_slope;
  return 3.14159265f * pixels * pixels < kSmallTriangle * static_cast<float>(triangles);
}

void MeshPass::prepare_item(const DrawItem& item, const View& view) {
  if (!item.mesh || item.mesh->empty()) return;
  Prepared prepared{};
  Instance& instance = prepared.instance;
  compose(view.camera_from_world, item.world_from_node, instance.camera_from_node);
  const Sphere sphere = bounding_sphere(item.mesh->bounds, instance.camera_from_node);
  const float depth = -sphere.center.z;
  if (sphere.radius >= 0) {
    const float radius = sphere.radius * 1.0001f;
    if (depth + radius < view.near_plane || depth - radius > view.far_plane ||
        (std::abs(sphere.center.x) - depth * view.tangents.x) * view.slopes.x > radius ||
        (std::abs(sphere.center.y) - depth * view.tangents.y) * view.slopes.y > radius)
      return;
  } else if (!std::isfinite(depth)) {
    return;
  }

  if (item.mesh.get() != last_mesh_) {
    last_slice_ = meshes_.find(item.mesh);
    last_mesh_ = item.mesh.get();
  }
  if (!last_slice_) return;
  prepared.slice = last_slice_;
  const Material& material = item.material;
  const bool surface = last_slice_->primitive == GL_TRIANGLES, shaded = surface && item.mesh->lit;
  const TextureStore::Entry* texture = nullptr;
  if (surface && item.texture.image && last_slice_->texture_coordinates) texture = textures_.find(item.texture.image);

  // VRML97 Tables 4.5 and 4.6; lines and points show the emissive colour (6.24, 6.36).
  DrawState& state = prepared.state;
  set(instance.base_color, !material.lit ? glm::vec3(1) : shaded ? material.diffuse : material.emissive);
  instance.alpha = material.lit ? 1 - material.transparency : 1;
  if (last_slice_->colors) state.variant |= kColors;
  if (shaded && material.lit) {
    state.variant |= kLit | (last_slice_->normals ? kNormals : 0u);
    state.lights = lights_.choose(item.directional_lights, sphere.center, sphere.radius);
    set(instance.emissive, material.emissive);
    instance.ambient_intensity = material.ambient_intensity;
    set(instance.specular, material.specular);
    if (material.specular != glm::vec3(0)) state.variant |= kSpecular;
    if (!lights_.directional_only(state.lights)) state.variant |= kLocalLights;
    instance.shininess = material.shininess * kShininessScale;
  }
  bool transparent = instance.alpha < 1;
  if (texture) {
    state.variant |= kTexture | (texture->intensity ? kIntensity : 0u);
    state.texture = texture_number(item.texture, *texture);
    if (item.texture.image->has_alpha()) {
      instance.alpha = 1;
      transparent = texture->alpha == TextureStore::Alpha::blended;
      if (transparent) state.variant |= kTextureAlpha;
      if (texture->alpha == TextureStore::Alpha::cut_out) state.variant |= kCutOut;
    }
  }
  if (light_per_vertex(prepared, depth, sphere.radius, view)) state.variant |= kPerVertex;
  if (instance.alpha <= 0 || !build(state.variant)) return;
  state.cull = surface && item.mesh->solid;
  state.mirrored = surface && mirrors(instance.camera_from_node);
  const std::uint64_t mesh = std::uint64_t{last_slice_->page} << 32 | last_slice_->order;
  (transparent ? transparent_ : opaque_)
      .push_back({state.packed(), mesh, depth, static_cast<std::uint32_t>(prepared_.size())});
  prepared_.push_back(prepared);
}

void MeshPass::prepare(const RenderList& list, const View& view) {
  prepared_.clear();
  opaque_.clear();
  transparent_.clear();
  texture_bindings_.assign(1, {});
  binding_numbers_.clear();
  last_mesh_ = nullptr;
  last_slice_ = nullptr;
  for (const DrawItem& item : list.items) prepare_item(item, view);

  std::sort(opaque_.begin(), opaque_.end(), [](const SortKey& a, const SortKey& b) {
    return std::tie(a.state, a.mesh, a.prepared) < std::tie(b.state, b.mesh, b.prepared);
  });
  std::sort(transparent_.begin(), transparent_.end(), [](const SortKey& a, const SortKey& b) {
    return a.depth != b.depth ? a.depth > b.depth : a.prepared < b.prepared;
  });
  instances_.clear();
  for (const auto* order : {&opaque_, &transparent_})
    for (const SortKey& key : *order) instances_.push_back(prepared_[key.prepared].instance);
}

bool MeshPass::apply(const DrawState& state, const glm::mat4& clip_from_camera) {
  const bool all = !anything_applied_;
  VariantProgram& program = programs_[state.variant];
  const bool switched = all || state.variant != applied_.variant;
  if (switched) {
    gl_.UseProgram(program.program.name());
    if (program.frame != frame_) {
      gl_.UniformMatrix4fv(program.clip_from_camera, 1, GL_FALSE, glm::value_ptr(clip_from_camera));
      program.frame = frame_;
    }
  }
  if ((state.variant & kLit) && (all || state.lights != applied_.lights || !(applied_.variant & kLit)))
    lights_.bind(state.lights);
  if ((state.variant & kTexture) && (switched || state.texture != applied_.texture)) {
    const TextureBinding& binding = texture_bindings_[state.texture];
    textures_.bind(*binding.entry, binding.repeat_s, binding.repeat_t);
    gl_.UniformMatrix3fv(program.texture_transform, 1, GL_FALSE, glm::value_ptr(binding.transform));
  }
  if (all || state.mirrored != applied_.mirrored) gl_.FrontFace(state.mirrored ? GL_CW : GL_CCW);
  if (all || state.cull != applied_.cull) (state.cull ? gl_.Enable : gl_.Disable)(GL_CULL_FACE);
  applied_ = state;
  anything_applied_ = true;
  return true;
}

void MeshPass::draw_sorted(const std::vector<SortKey>& order, std::size_t first_instance,
                           const glm::mat4& clip_from_camera, FrameStatistics& statistics) {
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && order[end].state == order[begin].state && order[end].mesh == order[begin].mesh) ++end;
    const Prepared& first = prepared_[order[begin].prepared];
    apply(first.state, clip_from_camera);
    meshes_.draw(*first.slice, first_instance + begin, end - begin);
    statistics.items += end - begin;
    ++statistics.draw_calls;
    if (first.slice->primitive == GL_TRIANGLES)
      statistics.triangles += static_cast<std::size_t>(first.slice->index_count) / 3 * (end - begin);
    begin = end;
  }
}

void MeshPass::draw(const RenderList& list, const Camera& camera, const glm::mat4& clip_from_camera,
                    const DrawOptions& options, FrameStatistics& statistics) {
  ++frame_;
  meshes_.forget_unused();
  textures_.forget_unused();
  meshes_.forget_binding();
  View view;
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(glm::mat3(camera.world_from_camera)));
  view.camera_from_world = glm::dmat4(rotation);
  view.camera_from_world[3] = glm::dvec4(-(rotation * glm::dvec3(camera.world_from_camera[3])), 1);
  view.tangents = {1 / clip_from_camera[0][0], 1 / clip_from_camera[1][1]};
  view.slopes = 1.0f / glm::sqrt(1.0f + view.tangents * view.tangents);
  view.near_plane = camera.near_plane;
  view.far_plane = camera.far_plane;
  view.pixels_per_slope = static_cast<float>(options.height) * 0.5f / view.tangents.y;

  lights_.begin(list.lights, view.camera_from_world, options.headlight);
  prepare(list, view);
  if (instances_.empty()) return;
  lights_.upload();
  meshes_.set_instances(instances_);

  anything_applied_ = false;
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LEQUAL);
  gl_.DepthMask(GL_TRUE);
  gl_.CullFace(GL_BACK);
  gl_.Disable(GL_BLEND);
  gl_.PointSize(kPointSize);
  draw_sorted(opaque_, 0, clip_from_camera, statistics);
  if (!transparent_.empty()) {
    gl_.Enable(GL_BLEND);
    gl_.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl_.DepthMask(GL_FALSE);
    draw_sorted(transparent_, opaque_.size(), clip_from_camera, statistics);
    gl_.DepthMask(GL_TRUE);
    gl_.Disable(GL_BLEND);
  }
  gl_.Disable(GL_CULL_FACE);
  gl_.FrontFace(GL_CCW);
}

}  // namespace gs::render
