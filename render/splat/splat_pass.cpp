#include "render/splat/splat_pass.h"

#include "render/collection/collector.h"
#include "render/gl/shaders.h"
#include "render/splat/splat_budget.h"
#include "render/splat/splat_closing.h"
#include "render/splat/splat_pieces.h"
#include "render/splat/splat_shaders.h"

#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

/// Returns the ClipPlanes of an item in its node space.
ClipSpace clip_in_node(const RenderList& list, const SplatItem& item) {
  ClipSpace clip;
  for (const std::uint16_t plane : item.clip_planes)
    if (clip.count < kMaxClipPlanes && plane < list.clip_planes.size())
      clip.planes[clip.count++] = glm::vec4(glm::transpose(item.world_from_node) * list.clip_planes[plane]);
  return clip;
}

/// Reports whether all arrays have consistent sizes.
bool has_whole_arrays(const qnv::Splats& splats) {
  const auto fits = [&](const auto& array) { return array.empty() || array.size() == splats.size(); };
  return splats.normals.size() == splats.size() && splats.weights.size() == splats.size() && fits(splats.colors) &&
         fits(splats.cells);
}

/// Saves and restores the caller's framebuffer bindings, which SplatPass::draw changes.
class SavedTarget {
 public:
  explicit SavedTarget(const Gl& gl) : gl_(gl) {
    gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_);
    gl.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_);
  }
  void bind() const {
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_));
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_));
  }

 private:
  const Gl& gl_;
  GLint draw_ = 0, read_ = 0;
};

/// Returns the material for shading. If vectors have diagnostic colours, only its transparency remains.
Material shown_material(const Material& material, ColorBy color_by) {
  if (color_by == ColorBy::own) return material;
  Material plain;
  plain.transparency = material.transparency;
  return plain;
}

Material shown_material(const SplatItem& item, ColorBy color_by) {
  Material material = shown_material(item.material, color_by);
  const qnv::Rgb8& own = item.geometry->color();
  if (item.own_color) material.diffuse = glm::vec3(own.r, own.g, own.b) / 255.0f;
  return material;
}

}  // namespace

SplatPass::SplatPass(const Gl& gl)
    : gl_(gl),
      lights_(gl),
      splat_gl_(gl),
      no_attributes_(make_vertex_array(gl)),
      normals_(make_texture(gl)),
      depths_(make_texture(gl)),
      colors_(make_texture(gl)) {
  for (const Texture* texture : {&normals_, &depths_, &colors_}) {
    gl.BindTexture(GL_TEXTURE_2D, texture->name());
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  }
}

const SplatPass::Shader* SplatPass::shader(bool colored, bool closing, bool fog, unsigned lights) {
  const auto [found, fresh] =
      shaders_.try_emplace(lights * 8u + (fog ? 4u : 0u) + (closing ? 2u : 0u) + (colored ? 1u : 0u));
  Shader& entry = found->second;
  if (fresh) {
    std::string text = "#define LOCAL_LIGHTS\n#define SPECULAR\n";
    if (colored) text += "#define COLORS\n";
    if (closing) text += "#define CLOSING\n";
    if (fog) text += "#define FOG\n";
    text += LightSets::defines(lights);
    auto made =
        make_program(gl_, text, kScreenVertexShader, std::string(kLightingShader) + kFogShader + kSplatFragmentShader);
    if (auto* program = std::get_if<Program>(&made)) {
      entry.program = std::move(*program);
      const GLuint name = entry.program.name();
      const auto at = [&](const char* uniform) { return gl_.GetUniformLocation(name, uniform); };
      entry.normals = at("normals");
      entry.depths = at("depths");
      entry.colors = at("colors");
      entry.origin = at("origin");
      entry.size = at("size");
      entry.rectangle = at("rectangle");
      entry.corner = at("corner");
      entry.closing = at("closing");
      entry.pixel = at("pixel");
      entry.tangents = at("tangents");
      entry.middle = at("middle");
      entry.depth_row = at("depth_row");
      entry.base = at("base");
      entry.emissive_ambient = at("emissive_ambient");
      entry.specular_exponent = at("specular_exponent");
      entry.fog = FogUniforms(gl_, name);
      entry.lights = LightUniforms(gl_, name);
    }
  }
  return entry.program ? &entry : nullptr;
}

void SplatPass::upload(const Texture& texture, int unit, GLenum internal, GLenum format, GLenum type,
                       const SplatLayer& layer, const void* pixels) {
  gl_.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  gl_.BindSampler(static_cast<GLuint>(unit), 0);
  gl_.BindTexture(GL_TEXTURE_2D, texture.name());
  gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), layer.width, layer.height, 0, format, type, pixels);
}

std::optional<SplatTextures> SplatPass::with_gl(std::span<const SharedSplatPiece> pieces, const SplatView& view,
                                                const DrawOptions& options) {
  if (options.splats == SplatPath::cpu || (options.splats == SplatPath::automatic && gl_.software)) return std::nullopt;
  return splat_gl_.draw(pieces, view);
}

SplatTextures SplatPass::on_processor(std::span<const SharedSplatPiece> shared, const SplatView& view,
                                      const SplatView& whole) {
  std::vector<SplatPiece> pieces;
  for (const SharedSplatPiece& p : shared) pieces.push_back({p.splats.get(), p.first, p.count, p.growth, p.tint});
  SplatLayer layer = rasterize_surface(pieces, view);
  close_pinholes(layer, view, closing_for(shared, whole));
  return upload(layer);
}

SplatTextures SplatPass::upload(const SplatLayer& layer) {
  SplatTextures result;
  result.discs = layer.discs;
  if (layer.empty()) return result;
  upload(normals_, 0, GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, layer, layer.normals.data());
  upload(depths_, 1, GL_R32F, GL_RED, GL_FLOAT, layer, layer.depth.data());
  if (!layer.colors.empty()) upload(colors_, 2, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, layer, layer.colors.data());
  result.normals = normals_.name();
  result.depths = depths_.name();
  result.colors = layer.colors.empty() ? 0 : colors_.name();
  result.x = result.left = layer.x;
  result.y = result.bottom = layer.y;
  result.width = layer.width;
  result.height = layer.height;
  return result;
}

void SplatPass::shade(const Material& m, const SplatTextures& textures, int closing, std::uint32_t light_set,
                      const CameraFog& fog, const Projection& projection, const DrawOptions& options) {
  const bool colored = textures.colors != 0;
  const Shader* s = shader(colored, closing > 0, fog.on, LightSets::variant(lights_.count(light_set)));
  if (!s) return;
  gl_.Viewport(options.x, options.y, options.width, options.height);
  gl_.Scissor(options.x + textures.x, options.y + textures.y, textures.width, textures.height);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(projection.reversed ? GL_GEQUAL : GL_LEQUAL);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const std::array<GLuint, 3> names{textures.normals, textures.depths, textures.colors};
  for (GLuint unit = 0; unit < (colored ? 3u : 2u); ++unit) {
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.BindSampler(unit, 0);
    gl_.BindTexture(GL_TEXTURE_2D, names[unit]);
  }
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.UseProgram(s->program.name());
  gl_.Uniform1i(s->normals, 0);
  gl_.Uniform1i(s->depths, 1);
  if (colored) gl_.Uniform1i(s->colors, 2);
  gl_.Uniform2i(s->origin, options.x, options.y);
  gl_.Uniform2i(s->size, options.width, options.height);
  const glm::vec4 rectangle(textures.x, textures.y, textures.x + textures.width, textures.y + textures.height);
  gl_.Uniform4fv(s->rectangle, 1, glm::value_ptr(rectangle));
  gl_.Uniform2i(s->corner, textures.left, textures.bottom);
  const glm::vec2 view_tangents = projection.tangents();
  gl_.Uniform1i(s->closing, closing);
  gl_.Uniform2f(s->pixel, 2 / static_cast<float>(options.width), 2 / static_cast<float>(options.height));
  gl_.Uniform2f(s->tangents, view_tangents.x, view_tangents.y);
  gl_.Uniform2f(s->middle, projection.center().x, projection.center().y);
  gl_.Uniform2f(s->depth_row, projection.depth_offset, projection.depth_scale);
  const glm::vec4 base(m.diffuse, 1 - m.transparency), emissive(m.emissive, m.ambient_intensity),
      specular(m.specular, m.shininess * kShininessScale);
  gl_.Uniform4fv(s->base, 1, glm::value_ptr(base));
  gl_.Uniform4fv(s->emissive_ambient, 1, glm::value_ptr(emissive));
  gl_.Uniform4fv(s->specular_exponent, 1, glm::value_ptr(specular));
  if (fog.on) s->fog.set(gl_, fog);
  lights_.bind(light_set, s->lights);
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void SplatPass::draw_layer(const SplatLayer& layer, const RenderList& list, const DrawItem& item, const Camera& camera,
                           const Projection& projection, const DrawOptions& options) {
  if (layer.empty()) return;
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  lights_.begin(list.lights, camera_from_world, options);
  const WideBox bounds = world_bounds(item.mesh->bounds, item.world_from_node);
  const glm::dvec3 center = (glm::dvec3(bounds.lower) + glm::dvec3(bounds.upper)) * 0.5;
  const std::uint32_t set =
      lights_.choose(item.directional_lights, glm::vec3(camera_from_world * glm::dvec4(center, 1)),
                     glm::length(bounds.upper - bounds.lower) * 0.5f);
  lights_.upload();
  const SavedTarget target(gl_);
  const SplatTextures textures = upload(layer);
  target.bind();
  shade(shown_material(item.material, options.splat_style.color_by), textures, 0, set,
        camera_fog(list.fog, glm::mat3(camera.world_from_camera), projection.back), projection, options);
  gl_.Viewport(options.x, options.y, options.width, options.height);
  gl_.Scissor(options.x, options.y, options.width, options.height);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
}

void SplatPass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                     const DrawOptions& options, FrameStatistics& statistics) {
  splat_gl_.forget_unused();
  if (list.splats.empty()) return;
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  lights_.begin(list.lights, camera_from_world, options);
  const CameraFog fog = camera_fog(list.fog, glm::mat3(camera.world_from_camera), projection.back);
  std::vector<std::uint32_t> sets;
  for (const SplatItem& item : list.splats) {
    const Box& box = item.geometry->description().box;
    const glm::dmat4 camera_from_node = camera_from_world * item.world_from_node;
    const glm::vec3 center(camera_from_node * glm::dvec4((glm::dvec3(box.lower) + glm::dvec3(box.upper)) * 0.5, 1));
    double radius = 0;
    for (int i = 0; i < 3; ++i) radius += glm::length(glm::dvec3(camera_from_node[i])) * box.size()[i] * 0.5;
    sets.push_back(lights_.choose(item.directional_lights, center, static_cast<float>(radius)));
  }
  lights_.upload();
  const SavedTarget target(gl_);
  SplatView view = viewport_view(camera, projection, options);
  view.supersample = options.samples > 1 ? 2 : 1;
  view.color_by_normal = options.splat_style.color_by == ColorBy::normal;
  // Cut for the whole image, so that its tiles match.
  SplatView whole = whole_view(view, camera);
  const std::vector<std::size_t> shares =
      share_budget(list.splats, budget_view(whole, camera_from_world), options.budget);
  std::size_t streams = 0, decodable = options.most_decoded;
  for (const SplatItem& item : list.splats) streams += item.geometry->as<qnv::OctreeSplats>() ? 1 : 0;
  std::unordered_map<const qnv::ChunkRequests*, std::uint32_t> shown;  // instances of each stream so far
  for (std::size_t i = 0; i < list.splats.size(); ++i) {
    const SplatItem& item = list.splats[i];
    const auto* splats = item.geometry->as<qnv::Splats>();
    const auto* octree = item.geometry->as<qnv::OctreeSplats>();
    if (splats ? !has_whole_arrays(*splats) : !octree) continue;
    whole.camera_from_node = view.camera_from_node = glm::mat4(camera_from_world * item.world_from_node);
    view.clip = clip_in_node(list, item);
    CutOptions wanted{shares[i], 0, item.detail, options.viewport, options.splat_style.color_by};
    // Each instance of a stream keeps its own level of detail.
    if (const auto* requests = item.geometry->base().requests.get()) wanted.viewport += shown[requests]++ << 16;
    if (octree && options.most_decoded > 0) wanted.most_decoded = std::max<std::size_t>(decodable / streams--, 1);
    const SplatCut cut = [&] {
      const PhaseScope phase(gl_.phases, Phase::cut);
      return cut_splats(item.geometry, whole, wanted);
    }();
    const std::vector<SharedSplatPiece>& pieces = cut.pieces;
    statistics.pending = statistics.pending || cut.pending;
    decodable -= std::min(decodable, cut.decoded);
    if (pieces.empty()) continue;
    std::optional<SplatTextures> textures = with_gl(pieces, view, options);
    const bool by_gl = textures.has_value();
    target.bind();
    if (!textures) textures = on_processor(pieces, view, whole);
    statistics.vectors += textures->discs;
    statistics.draw_calls += textures->draw_calls;
    // The statistics show that OpenGL could not draw splats.
    if (!by_gl || std::string_view(statistics.splats) == "none") statistics.splats = by_gl ? "gl" : "cpu";
    if (textures->normals == 0) continue;
    shade(shown_material(item, options.splat_style.color_by), *textures, by_gl ? closing_for(pieces, whole) : 0,
          sets[i], fog, projection, options);
    ++statistics.draw_calls;
  }
  gl_.Viewport(options.x, options.y, options.width, options.height);
  gl_.Scissor(options.x, options.y, options.width, options.height);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
}

}  // namespace gs::render
