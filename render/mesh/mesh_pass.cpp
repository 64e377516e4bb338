#include "render/mesh/mesh_pass.h"

#include "render/gl/shaders.h"
#include "render/gl/style_shaders.h"

#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace gs::render {
namespace {

// Bytes of meshes that are uploaded between two calls of `go_on`. The meshes of a large world take seconds.
constexpr std::size_t kUploadedBetween = std::size_t{4} << 20;
constexpr float kPointSize = 2;
constexpr float kMaxDeviation = 0.4f;  // pixels: maximum deviation of a coarser version of a surface
constexpr const char* kDefines[] = {"LIT",      "NORMALS", "TEXTURE",      "CUT_OUT", "LOCAL_LIGHTS", "SPECULAR",
                                    "EMISSIVE", "FOG",     "SMOOTH_EDGES", "MASK",    "STYLE"};

/// Computes the matrix from node space, relative to `origin`, to camera space. Uses double precision, because
/// differences of large coordinates must stay exact.
void compose(const glm::dmat4& camera_from_world, const glm::dmat4& world_from_node, const glm::vec3& origin,
             float (&rows)[3][4]) {
  for (int row = 0; row < 3; ++row) {
    double at_origin = 0;
    for (int column = 0; column < 4; ++column) {
      double sum = column == 3 ? camera_from_world[3][row] : 0.0;
      for (int k = 0; k < 3; ++k) sum += camera_from_world[k][row] * world_from_node[column][k];
      if (column < 3)
        at_origin += sum * double{origin[column]};
      else
        sum += at_origin;
      rows[row][column] = static_cast<float>(sum);
    }
  }
}

struct Sphere {
  glm::vec3 center;
  float radius;  // negative if the size is unknown
};

/// Returns a sphere around the mesh's box, in camera space. `rows` comes from compose().
Sphere bounding_sphere(const Box& bounds, const glm::vec3& origin, const float (&rows)[3][4]) {
  if (bounds.empty()) return {glm::vec3(rows[0][3], rows[1][3], rows[2][3]), -1};
  const glm::vec3 center = bounds.center() - origin, half = bounds.size() * 0.5f;
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

/// Reports whether the texture covers each point of the item (X3D 12.4.6).
bool is_sprite(const DrawItem& item, const MeshStore::Slice& slice) {
  return slice.primitive == GL_POINTS && item.style && item.style->sized_points;
}

void set(float (&to)[3], const glm::vec3& from) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

}  // namespace

MeshPass::PackedState MeshPass::DrawState::packed() const {
  return {std::uint64_t{variant} << 2 | std::uint64_t{mirrored} << 1 | std::uint64_t{cull},
          std::uint64_t{style} << 48 | std::uint64_t{lights} << 32 | texture};
}

std::variant<std::unique_ptr<MeshPass>, ContextError> MeshPass::create(const Gl& gl) {
  std::unique_ptr<MeshPass> pass(new MeshPass(gl));
  // Build the variant that nearly all worlds need now. Other variants are built at first use.
  if (!pass->program(kLit | kNormals | kFirstLightBit * LightSets::variant(1))) return ContextError{pass->last_error_};
  return pass;
}

MeshPass::MeshPass(const Gl& gl) : gl_(gl), meshes_(gl), textures_(gl), lights_(gl) {}

MeshPass::VariantProgram* MeshPass::program(unsigned variant) {
  if (last_program_ && variant == last_variant_) return last_program_;
  const auto [found, fresh] = programs_.try_emplace(variant);
  VariantProgram& entry = found->second;
  if (fresh) {
    const bool per_sample = (variant & kSmoothEdges) && gl_.sample_shading;
    std::string text = per_sample
                           ? "#extension GL_ARB_gpu_shader5 : require\n#define PER_SAMPLE\n#define SAMPLED sample\n"
                           : "#define SAMPLED\n";
    for (unsigned bit = 0; bit < std::size(kDefines); ++bit)
      if (variant >> bit & 1) text.append("#define ").append(kDefines[bit]).append("\n");
    text += "#define MOST_PLANES " + std::to_string(kMaxClipPlanes) + "\n";
    std::string fragment;
    if (variant & kLit) {
      text += LightSets::defines(variant / kFirstLightBit);
      fragment = kLightingShader;
    }
    if (variant & kFog) fragment += kFogShader;
    std::string vertex;
    if (variant & kStyle) {
      vertex = kStyleVertexShader;
      fragment += kStyleFragmentShader;
    }
    auto made =
        make_program(gl_, text, vertex + kMeshAttributesShader + kMeshVertexShader, fragment + kMeshFragmentShader);
    if (auto* error = std::get_if<ContextError>(&made)) {
      last_error_ = std::move(error->message);
    } else {
      entry.program = std::move(std::get<Program>(made));
      entry.find_uniforms(gl_, (variant & kStyle) != 0);
    }
  }
  if (!entry.program) return nullptr;
  last_variant_ = variant;
  last_program_ = &entry;
  return &entry;
}

std::uint32_t MeshPass::texture_number(const TextureUse& use, const TextureStore::Entry& entry) {
  const auto [first, last] = binding_numbers_.equal_range(entry.order);
  for (auto found = first; found != last; ++found) {
    const TextureBinding& binding = texture_bindings_[found->second];
    if (binding.repeat_s == use.repeat_s && binding.repeat_t == use.repeat_t && binding.transform == use.transform &&
        binding.modulates == use.modulates && binding.sampling == use.sampling)
      return found->second;
  }
  const auto number = static_cast<std::uint32_t>(texture_bindings_.size());
  TextureBinding binding;
  binding.entry = &entry;
  binding.repeat_s = use.repeat_s;
  binding.repeat_t = use.repeat_t;
  binding.transform = use.transform;
  binding.modulates = use.modulates;
  binding.sampling = use.sampling;
  texture_bindings_.push_back(std::move(binding));
  binding_numbers_.emplace(entry.order, number);
  return number;
}

bool MeshPass::View::contains(const glm::vec3& sphere, float radius) const {
  const float depth = back - sphere.z;
  if (radius < 0) return std::isfinite(depth);
  radius *= 1.0001f;  // margin for rounding errors
  return depth + radius >= near_plane && depth - radius <= far_plane &&
         (depth * (center.x - tangents.x) - sphere.x) * low.x <= radius &&
         (depth * (center.y - tangents.y) - sphere.y) * low.y <= radius &&
         (sphere.x - depth * (center.x + tangents.x)) * high.x <= radius &&
         (sphere.y - depth * (center.y + tangents.y)) * high.y <= radius;
}

float MeshPass::View::pattern_scale(const DrawItem& item, const Instance& instance, float depth) const {
  float scale = 0;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      scale += instance.camera_from_node[row][column] * instance.camera_from_node[row][column];
  const float width = item.style ? std::max(item.style->line_width, 1.0f) : 1;
  return std::sqrt(scale / 3) * pixels / (std::max(depth, 1e-6f) * width);
}

void MeshPass::prepare_item(const DrawItem& item, const View& view) {
  if (!item.visible || !item.mesh || item.mesh->empty() || is_hidden(item)) return;
  Prepared prepared{};
  Instance& instance = prepared.instance;
  const glm::vec3 origin = local_origin(item.mesh->bounds);
  compose(view.camera_from_world, item.world_from_node, origin, instance.camera_from_node);
  const Sphere sphere = bounding_sphere(item.mesh->bounds, origin, instance.camera_from_node);
  const float depth = view.back - sphere.center.z;
  if (!view.contains(sphere.center, sphere.radius)) return;
  if (item.volume) {
    casts_.push_back({&item, sphere.center, sphere.radius, depth});
    return;
  }
  const bool styled = ItemStyles::has_style(item);
  if (item.mesh->pictured && !styled && prepare_text(item, sphere.center, sphere.radius, origin, prepared)) return;
  const std::shared_ptr<const vrml::Mesh>* mesh_seen = &item.mesh;
  if (item.patches()) {
    mesh_seen = view.surfaces ? view.surfaces->mesh_of(item) : nullptr;
    if (!mesh_seen) return;
  }
  if (const float nearest = depth - sphere.radius; item.mesh->coarser && sphere.radius >= 0 && nearest > 0) {
    const float pixels = sphere.radius / nearest * view.pixels;
    while ((*mesh_seen)->coarser && pixels * (*mesh_seen)->coarser_error <= kMaxDeviation)
      mesh_seen = &(*mesh_seen)->coarser;
  }
  if (mesh_seen->get() != last_mesh_) {
    last_slice_ = meshes_.find(*mesh_seen);
    last_mesh_ = mesh_seen->get();
  }
  if (!last_slice_) return;
  prepared.slice = last_slice_;
  if (last_slice_->origin != origin)
    compose(view.camera_from_world, item.world_from_node, last_slice_->origin, instance.camera_from_node);
  prepared.mesh = mesh_seen->get();
  const Material& material = item.material;
  const bool surface = last_slice_->primitive == GL_TRIANGLES;
  // A pattern of lines uses the place of the specular exponent.
  const bool patterned = item.style && item.style->line_pattern != ShapeStyle::kSolidLine &&
                         item.mesh->primitive == vrml::Mesh::Primitive::lines;
  const bool shaded = item.mesh->lit && (surface || (last_slice_->normals && !patterned));
  const TextureStore::Entry* texture = nullptr;
  if ((*mesh_seen)->pictured) {
    if (!find_glyphs()) return;
  } else if (!item.layered && item.texture.image &&
             (surface ? last_slice_->texture_coordinates : is_sprite(item, *last_slice_))) {
    texture = textures_.find(item.texture.image);
  }

  // VRML97 Tables 4.5 and 4.6. Lines and points use the emissive colour (6.24, 6.36).
  DrawState& state = prepared.state;
  if (fog_.on) state.variant |= kFog;
  set(instance.base_color, !material.lit ? material.unlit : shaded ? material.diffuse : material.emissive);
  instance.alpha = 1 - material.transparency;
  if (shaded && material.lit) {
    state.variant |= kLit | (last_slice_->normals ? kNormals : 0u);
    state.lights = lights_.choose(item.directional_lights, sphere.center, sphere.radius);
    set(instance.emissive, material.emissive);
    instance.ambient_intensity = material.ambient_intensity;
    set(instance.specular, material.specular);
    state.variant |= frame_variant_;
    const unsigned lights = LightSets::variant(lights_.count(state.lights));
    state.variant |= kFirstLightBit * lights;
    // Large sets rarely have only directional lights. Treat all of them as local, which saves a program.
    if (lights >= LightSets::kLoop || !lights_.directional_only(state.lights)) state.variant |= kLocalLights;
    if (material.specular == glm::vec3(0) &&
        worth_own_program(state.variant & ~unsigned{kSpecular}, sphere.radius, depth, view))
      state.variant &= ~unsigned{kSpecular};
    instance.shininess = material.shininess * kShininessScale;
  }
  if (styled || (last_slice_->fog_depths && fog_.on)) {
    if (item.style && surface && !item.style->filled && !item.style->hatched) return;
    state.variant |= kStyle;
    state.style = styles_.number_of(item, last_slice_->primitive);
    if (styles_.has_fog(state.style)) state.variant |= kFog;
    if (!shaded) instance.shininess = view.pattern_scale(item, instance, std::max(depth, sphere.radius * 0.25f));
  }
  bool transparent = instance.alpha < 1 || item.mesh->translucent;
  if (item.mesh->pictured) {
    state.variant |= kTexture | kCutOut | (several_samples_ ? kSmoothEdges : 0u);
    state.texture = texture_number({}, *glyphs_);
  }
  if (texture) {
    state.variant |= kTexture;
    state.texture = texture_number(item.texture, *texture);
    if (item.texture.image->has_alpha()) {
      if (!item.texture.modulates) instance.alpha = 1;
      transparent = texture->alpha == TextureStore::Alpha::blended || instance.alpha < 1 || item.mesh->translucent;
      if (texture->alpha == TextureStore::Alpha::cut_out) state.variant |= kCutOut;
    }
  }
  if (item.layered && surface && !(*mesh_seen)->pictured) prepare_layers(item, prepared, transparent);
  const bool invisible = instance.alpha <= 0 && !last_slice_->opacities;
  if (invisible || !program_of(state)) return;
  state.cull = surface && item.mesh->solid && !view.open;
  state.mirrored = surface && mirrors(instance.camera_from_node);
  const std::uint64_t mesh = std::uint64_t{last_slice_->page} << 32 | last_slice_->order;
  const std::uint32_t layer = transparent ? 0 : filled_.layer_of(sphere.center, sphere.radius, state.packed());
  (transparent ? transparent_ : opaque_)
      .push_back({layer, state.packed(), mesh, depth, static_cast<std::uint32_t>(prepared_.size())});
  prepared_.push_back(prepared);
}

/// Reports whether to draw an item with a program of its own, which computes less but must be compiled. Software
/// drivers compile it for items that fill much of the picture, after the first frames of a window.
bool MeshPass::worth_own_program(unsigned variant, float radius, float depth, const View& view) const {
  constexpr std::uint64_t kFirstFrames = 16;
  constexpr float kLarge = 0.5f;  // min radius of the item, as a fraction of half the height of the picture
  if (!gl_.software) return false;
  if (programs_.contains(variant)) return true;
  return view.cancellable && frame_ > kFirstFrames && radius > kLarge * view.tangents.y * std::abs(depth);
}

unsigned MeshPass::ItemsVariant::of(const RenderList& list) {
  unsigned lights = 0;
  for (const Light& light : list.lights)
    if (light.ambient_intensity > 0) lights |= kEmissive;
  if (list.generation != 0 && list.generation == generation_ && list.dressed == dressed_) return lights | bits_;
  bits_ = 0;
  for (const DrawItem& item : list.items) {
    if (!item.material.lit) continue;
    if (item.material.specular != glm::vec3(0)) bits_ |= kSpecular;
    if (item.material.emissive != glm::vec3(0)) bits_ |= kEmissive;
  }
  generation_ = list.generation;
  dressed_ = list.dressed;
  return lights | bits_;
}

bool MeshPass::prepare(const RenderList& list, const View& view, bool overlays, const std::function<bool()>& go_on) {
  prepared_.clear();
  opaque_.clear();
  transparent_.clear();
  texture_bindings_.assign(1, {});
  binding_numbers_.clear();
  layered_numbers_.clear();
  casts_.clear();
  glyphs_ = nullptr;
  last_mesh_ = nullptr;
  last_slice_ = nullptr;
  frame_variant_ = items_variant_.of(list);
  glm::dmat4 camera_from_world = view.camera_from_world;
  camera_from_world[3].z -= double{view.back};
  const auto* found =
      visible_.find(list, Frustum(camera_from_world, view.tangents, view.near_plane, view.far_plane, view.center));
  const std::size_t count = found ? found->size() : list.items.size();
  filled_.begin(count);
  std::size_t asked_at = meshes_.uploaded();
  for (std::size_t i = 0; i < count; ++i) {
    if (const DrawItem& item = list.items[found ? (*found)[i] : i]; item.overlay == overlays) prepare_item(item, view);
    if (!go_on || meshes_.uploaded() - asked_at < kUploadedBetween) continue;
    if (!go_on()) return false;
    asked_at = meshes_.uploaded();
  }

  // Among equal states, draw near items first, so that hidden pixels are not shaded.
  std::sort(opaque_.begin(), opaque_.end(), [](const SortKey& a, const SortKey& b) {
    return std::tie(a.layer, a.state, a.mesh, a.depth, a.prepared) <
           std::tie(b.layer, b.state, b.mesh, b.depth, b.prepared);
  });
  std::sort(transparent_.begin(), transparent_.end(), [](const SortKey& a, const SortKey& b) {
    return a.depth != b.depth ? a.depth > b.depth : a.prepared < b.prepared;
  });
  sort_triangles();
  instances_.resize(opaque_.size() + transparent_.size());
  auto instance = instances_.begin();
  for (const auto* order : {&opaque_, &transparent_})
    for (const SortKey& key : *order) *instance++ = prepared_[key.prepared].instance;
  merge_texts();
  return true;
}

void MeshPass::apply(const DrawState& state, const Projection& projection) {
  const bool all = !anything_applied_;
  VariantProgram& shader = *program_of(state);
  const bool layered = (state.variant & kLayered) != 0;
  const bool switched = all || state.variant != applied_.variant || (layered && state.texture != applied_.texture);
  if (switched) {
    gl_.UseProgram(shader.program.name());
    if (shader.frame != frame_) {
      gl_.UniformMatrix4fv(shader.clip_from_camera, 1, GL_FALSE, glm::value_ptr(projection.clip_from_viewer));
      if (shader.eye_back >= 0) gl_.Uniform1f(shader.eye_back, projection.back);
      if (state.variant & kFog) shader.fog.set(gl_, fog_);
      shader.frame = frame_;
    }
  }
  if (state.variant & kStyle) {
    if (switched || state.style != applied_.style) styles_.apply(state.style, shader.style, shader.fog);
  } else {
    styles_.end();
  }
  if ((state.variant & kLit) &&
      (all || state.lights != applied_.lights || !(applied_.variant & kLit) || (switched && shader.lights.many >= 0)))
    lights_.bind(state.lights, shader.lights);
  if (layered && switched) apply_layers(texture_bindings_[state.texture], shader);
  if ((state.variant & kTexture) && (switched || state.texture != applied_.texture)) {
    const TextureBinding& binding = texture_bindings_[state.texture];
    if (binding.entry->mask)
      textures_.bind_mask(*binding.entry, several_samples_ || !gl_.software);
    else if (binding.sampling)
      textures_.bind(*binding.entry, *binding.sampling, 0);
    else
      textures_.bind(*binding.entry, binding.repeat_s, binding.repeat_t);
    gl_.UniformMatrix3fv(shader.texture_transform, 1, GL_FALSE, glm::value_ptr(binding.transform));
    const TextureStore::Entry& texture = *binding.entry;
    const bool blended = texture.alpha == TextureStore::Alpha::blended;
    gl_.Uniform2i(shader.replaces, texture.intensity || binding.modulates ? 0 : 1,
                  !blended            ? 0
                  : binding.modulates ? 2
                                      : 1);
  }
  if (several_samples_ && (all || ((state.variant ^ applied_.variant) & (kSmoothEdges | kLayered)))) {
    const bool coverage = (state.variant & kSmoothEdges) && (!gl_.sample_shading || (state.variant & kLayered));
    (coverage ? gl_.Enable : gl_.Disable)(GL_SAMPLE_ALPHA_TO_COVERAGE);
  }
  if (all || state.mirrored != applied_.mirrored) gl_.FrontFace(state.mirrored ? GL_CW : GL_CCW);
  if (all || state.cull != applied_.cull) (state.cull ? gl_.Enable : gl_.Disable)(GL_CULL_FACE);
  applied_ = state;
  anything_applied_ = true;
}

void MeshPass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                    const DrawOptions& options, FrameStatistics& statistics, const std::function<void()>& between,
                    const SurfacePass* surfaces, bool overlays) {
  ++frame_;
  meshes_.forget_unused();
  textures_.forget_unused();
  layer_textures_.forget_unused();
  meshes_.forget_binding();
  View view;
  view.surfaces = surfaces;
  view.camera_from_world = camera_from_world_of(camera);
  view.camera_from_world[3].z += camera.back;
  view.back = projection.back;
  view.open = options.display == DisplayMode::wireframe || options.display == DisplayMode::points;
  view.tangents = projection.tangents();
  view.center = projection.center();
  const glm::vec2 low = view.center - view.tangents, high = view.center + view.tangents;
  view.low = 1.0f / glm::sqrt(1.0f + low * low);
  view.high = 1.0f / glm::sqrt(1.0f + high * high);
  view.near_plane = camera.near_plane;
  view.cancellable = static_cast<bool>(options.go_on);
  view.far_plane = camera.far_plane;
  view.pixels = static_cast<float>(options.height) / (2 * view.tangents.y * static_cast<float>(options.pixel_side));

  world_from_camera_ = glm::mat3(camera.world_from_camera);
  fog_ = camera_fog(list.fog, world_from_camera_);
  styles_.begin_frame(
      {&list, view.camera_from_world, world_from_camera_, fog_, static_cast<float>(options.pixel_side)});
  lights_.begin(list.lights, view.camera_from_world, options);
  GLint samples = 0;  // samples per pixel of the bound target
  gl_.GetIntegerv(GL_SAMPLES, &samples);
  several_samples_ = samples > 1;
  if (!prepare(list, view, overlays, options.go_on)) {
    statistics.given_up = true;
    return;
  }
  if (!casts_.empty()) {
    if (!volumes_) volumes_.emplace(gl_);
    volumes_->begin({&list, view.camera_from_world, world_from_camera_, projection, camera.near_plane, &options},
                    casts_);
  }
  if (instances_.empty() && casts_.empty()) {
    between();
    return;
  }
  lights_.upload();
  meshes_.set_instances(instances_);
  if (!sorted_indices_.empty()) meshes_.set_sorted_indices(sorted_indices_);

  anything_applied_ = false;
  primitives_ = 0;
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(projection.reversed ? GL_GEQUAL : GL_LEQUAL);
  gl_.DepthMask(GL_TRUE);
  gl_.CullFace(GL_BACK);
  gl_.Disable(GL_BLEND);
  gl_.PointSize(kPointSize * static_cast<float>(options.pixel_side));
  gl_.LineWidth(static_cast<float>(options.pixel_side));
  batch(opaque_, 0);
  std::sort(batches_.begin(), batches_.end(), [](const Batch& a, const Batch& b) {
    return std::tie(a.layer, a.state, a.page, a.depth, a.first) < std::tie(b.layer, b.state, b.page, b.depth, b.first);
  });
  // Push faces back by the change of depth over two pixels, so that lines and points on them are fully visible.
  const bool marked = std::any_of(batches_.begin(), batches_.end(), [&](const Batch& one) {
    return prepared_[one.prepared].slice->primitive != GL_TRIANGLES;
  });
  gl_.PolygonOffset(projection.reversed ? -2 : 2, projection.reversed ? -2 : 2);
  const bool edges = options.display == DisplayMode::edges;
  if (marked || edges) gl_.Enable(GL_POLYGON_OFFSET_FILL);
  const GLenum polygon_mode = options.display == DisplayMode::wireframe ? GL_LINE
                              : options.display == DisplayMode::points  ? GL_POINT
                                                                        : GL_FILL;
  gl_.PolygonMode(GL_FRONT_AND_BACK, polygon_mode);
  DrawPacer pacer(gl_, options.go_on,
                  static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  draw_batches(projection, statistics, pacer);
  styles_.end();
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
  gl_.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  if (edges && !pacer.given_up()) draw_edges(projection, pacer);
  if (!pacer.given_up()) {
    gl_.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    between();
    draw_transparent(projection, polygon_mode, statistics, pacer, marked);
  }
  gl_.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
  gl_.Disable(GL_CULL_FACE);
  gl_.FrontFace(GL_CCW);
  gl_.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  gl_.LineWidth(1);
  unbind_layers();
  statistics.given_up = statistics.given_up || pacer.given_up();
}

}  // namespace gs::render
