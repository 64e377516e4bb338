#include "render/gl/layered_program.h"
#include "render/gl/layered_shaders.h"
#include "render/gl/shaders.h"
#include "render/gl/style_shaders.h"
#include "render/mesh/mesh_pass.h"

#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <string>
#include <utility>

// Part of MeshPass for LayeredMaterials. Their programs are built at first use, one per combination of layers.
namespace gs::render {
namespace {

/// Returns the texture unit of a layer. Skips the unit of the lights.
GLuint unit_of(std::size_t layer) { return static_cast<GLuint>(layer < LightSets::kUnit ? layer : layer + 1); }

bool changes_alpha(const TextureLayer& layer) {
  if (layer.target == TextureLayer::Target::main) return true;
  return layer.target == TextureLayer::Target::stage && layer.alpha_mode != TextureLayer::Mode::off &&
         layer.alpha_mode != TextureLayer::Mode::select_2;
}

glm::vec4 with(const glm::vec3& color, float last) { return {color, last}; }

}  // namespace

/// Reports whether an item reflects the cube that is being drawn.
bool MeshPass::is_hidden(const DrawItem& item) const {
  return hidden_cube_ && item.layered &&
         std::any_of(item.layered->layers.begin(), item.layered->layers.end(),
                     [&](const TextureLayer& layer) { return layer.scene_cube.get() == hidden_cube_; });
}

MeshPass::VariantProgram* MeshPass::program_of(const DrawState& state) {
  return (state.variant & kLayered) != 0 ? layered_program(state.variant, texture_bindings_[state.texture])
                                         : program(state.variant);
}

void MeshPass::VariantProgram::find_uniforms(const Gl& gl, bool styled) {
  const GLuint name = program.name();
  clip_from_camera = gl.GetUniformLocation(name, "clip_from_camera");
  texture_transform = gl.GetUniformLocation(name, "texture_transform");
  replaces = gl.GetUniformLocation(name, "replaces");
  eye_back = gl.GetUniformLocation(name, "eye_back");
  fog = FogUniforms(gl, name);
  lights = LightUniforms(gl, name);
  if (styled) style = StyleUniforms(gl, program.name());
}

MeshPass::VariantProgram* MeshPass::layered_program(unsigned variant, TextureBinding& binding) {
  if (binding.known_program && binding.known_variant == variant) return binding.known_program;
  std::string key = std::to_string(variant);
  key.append(1, ' ').append(std::to_string(binding.sets)).append(1, ' ').append(binding.program);
  const auto [found, fresh] = layered_programs_.try_emplace(std::move(key));
  VariantProgram& entry = found->second;
  if (!fresh && !entry.program) return nullptr;
  binding.known_variant = variant;
  binding.known_program = &entry;
  if (!fresh) return &entry;
  const LayeredMaterial& material = *binding.layered;
  const LayeredSource source = layered_source(material, binding.sets);
  std::string defines = source.defines + "#define MOST_PLANES " + std::to_string(kMaxClipPlanes) + "\n";
  std::string fragment = kLayeredFragmentInputs;
  const std::pair<Variant, const char*> names[] = {{kLit, "LIT"},
                                                   {kNormals, "NORMALS"},
                                                   {kFog, "FOG"},
                                                   {kCutOut, "CUT_OUT"},
                                                   {kSmoothEdges, "SMOOTH_EDGES"},
                                                   {kStyle, "STYLE"},
                                                   {kLocalLights, "LOCAL_LIGHTS"}};
  for (const auto& [bit, name] : names)
    if (variant & bit) defines.append("#define ").append(name).append("\n");
  if (variant & kLit) {
    defines += "#define SPECULAR\n" + LightSets::defines((variant & ~unsigned{kLayered}) / kFirstLightBit);
    if (material.model == LayeredMaterial::Model::physical) fragment += kPhysicalShader;
    fragment += kLightingShader;
  }
  if (variant & kFog) fragment += kFogShader;
  std::string vertex;
  if (variant & kStyle) {
    vertex = kStyleVertexShader;
    fragment += kStyleFragmentShader;
  }
  fragment += source.layers + kLayeredFragmentBegin + source.apply + kLayeredFragmentEnd;
  auto made = make_program(gl_, defines, vertex + kMeshAttributesShader + kLayeredVertexShader, fragment);
  if (auto* error = std::get_if<ContextError>(&made)) {
    last_error_ = std::move(error->message);
    binding.known_program = nullptr;
    return nullptr;
  }
  entry.program = std::move(std::get<Program>(made));
  entry.find_uniforms(gl_, (variant & kStyle) != 0);
  entry.layered.find(gl_, entry.program.name(), material.layers.size());
  anything_applied_ = false;
  return &entry;
}

void MeshPass::LayeredUniforms::find(const Gl& gl, GLuint program, std::size_t layer_count) {
  const auto place_of = [&](const std::string& uniform) { return gl.GetUniformLocation(program, uniform.c_str()); };
  world_from_camera = place_of("world_from_camera");
  factor = place_of("factor");
  amounts = place_of("amounts");
  metal_roughness = place_of("metal_roughness");
  mesh_origin = place_of("mesh_origin");
  back_main = place_of("back_main");
  back_emissive = place_of("back_emissive");
  back_specular = place_of("back_specular");
  back_metal_roughness = place_of("back_metal_roughness");
  gl.UseProgram(program);
  for (std::size_t i = 0; i < layer_count; ++i) {
    const std::string number = std::to_string(i);
    gl.Uniform1i(place_of("layer_" + number), static_cast<GLint>(unit_of(i)));
    layers.push_back({place_of("transform_" + number), place_of("generator_" + number)});
  }
}

/// Returns the number of the binding of the item's LayeredMaterial for meshes with `sets` coordinate sets.
std::uint32_t MeshPass::layered_number(const DrawItem& item, std::size_t sets) {
  const auto [known, fresh] = layered_numbers_.try_emplace({item.layered.get(), sets});
  if (!fresh) return known->second;
  TextureBinding binding;
  binding.layered = item.layered.get();
  binding.program = layered_key(*item.layered);
  binding.sets = sets;
  for (const TextureLayer& layer : item.layered->layers) {
    const TextureStore::Alpha alpha = layer_textures_.prepare(layer);
    if (changes_alpha(layer) && alpha != TextureStore::Alpha::none && binding.alpha != TextureStore::Alpha::blended)
      binding.alpha = alpha;
  }
  known->second = static_cast<std::uint32_t>(texture_bindings_.size());
  texture_bindings_.push_back(std::move(binding));
  return known->second;
}

/// Completes a prepared item that has a LayeredMaterial. Sets whether it must be blended.
void MeshPass::prepare_layers(const DrawItem& item, Prepared& prepared, bool& transparent) {
  using AlphaMode = LayeredMaterial::AlphaMode;
  const LayeredMaterial& material = *item.layered;
  DrawState& state = prepared.state;
  state.variant &= kLit | kNormals | kFog | kLocalLights | kStyle | 7 * kFirstLightBit;
  state.variant |= kLayered;
  if (needs_normals(material) && prepared.slice->normals) state.variant |= kNormals;
  state.texture = layered_number(item, prepared.slice->coordinate_sets);
  const TextureStore::Alpha alpha = texture_bindings_[state.texture].alpha;
  const bool automatic = material.alpha_mode == AlphaMode::automatic;
  const bool back_transparent = material.has_back && material.back.transparency > 0;
  transparent = material.alpha_mode == AlphaMode::blend ||
                (automatic && (prepared.instance.alpha < 1 || item.mesh->translucent ||
                               alpha == TextureStore::Alpha::blended || back_transparent));
  if (material.alpha_mode == AlphaMode::mask || (automatic && !transparent && alpha == TextureStore::Alpha::cut_out))
    state.variant |= kCutOut | (several_samples_ ? kSmoothEdges : 0u);
  if (material.model == LayeredMaterial::Model::physical) {
    const glm::vec3 base = linear_of_display(item.material.diffuse),
                    emissive = linear_of_display(item.material.emissive);
    std::copy_n(&base.x, 3, prepared.instance.base_color);
    std::copy_n(&emissive.x, 3, prepared.instance.emissive);
  }
  // The colour of the front may be invisible, but not that of the back.
  if (material.alpha_mode == AlphaMode::opaque || material.has_back)
    prepared.instance.alpha = std::max(prepared.instance.alpha, 1e-6f);
}

void MeshPass::apply_layers(const TextureBinding& binding, const VariantProgram& program) {
  const LayeredMaterial& material = *binding.layered;
  const LayeredUniforms& uniforms = program.layered;
  for (std::size_t i = 0; i < material.layers.size(); ++i) {
    const TextureLayer& layer = material.layers[i];
    layer_textures_.bind(layer, unit_of(i));
    gl_.UniformMatrix4fv(uniforms.layers[i].transform, 1, GL_FALSE, glm::value_ptr(layer.transform));
    gl_.Uniform3fv(uniforms.layers[i].generator, 2, layer.parameters.data());
  }
  bound_layers_ = std::max(bound_layers_, material.layers.size());
  const BackMaterial& back = material.back;
  const glm::vec4 amounts(material.normal_scale, material.occlusion_strength, material.alpha_cutoff, 0);
  gl_.UniformMatrix3fv(uniforms.world_from_camera, 1, GL_FALSE, glm::value_ptr(world_from_camera_));
  gl_.Uniform4fv(uniforms.factor, 1, &material.factor.x);
  gl_.Uniform4fv(uniforms.amounts, 1, &amounts.x);
  gl_.Uniform2f(uniforms.metal_roughness, material.metallic, material.roughness);
  if (!material.has_back) return;
  const bool physical = material.model == LayeredMaterial::Model::physical;
  const auto color = [&](const glm::vec3& given) { return physical ? linear_of_display(given) : given; };
  const glm::vec4 main = with(color(back.main), 1 - back.transparency),
                  emissive = with(color(back.emissive), back.ambient_intensity),
                  specular = with(back.specular, back.shininess * kShininessScale);
  gl_.Uniform4fv(uniforms.back_main, 1, &main.x);
  gl_.Uniform4fv(uniforms.back_emissive, 1, &emissive.x);
  gl_.Uniform4fv(uniforms.back_specular, 1, &specular.x);
  gl_.Uniform2f(uniforms.back_metal_roughness, back.metallic, back.roughness);
}

/// Removes the samplers of layers, because other passes use the texture units.
void MeshPass::unbind_layers() {
  for (std::size_t i = 0; i < std::exchange(bound_layers_, 0); ++i) gl_.BindSampler(unit_of(i), 0);
}

std::vector<MeshPass::CubeRequest> MeshPass::cubes_to_draw(const RenderList& list) {
  using Update = SceneCube::Update;
  std::vector<CubeRequest> requests;
  for (const DrawItem& item : list.items) {
    if (!item.layered || !item.visible) continue;
    for (const TextureLayer& layer : item.layered->layers) {
      const auto& cube = layer.scene_cube;
      if (!cube || cube->update == Update::none || requests.size() >= kMaxCubes) continue;
      const bool known =
          std::any_of(requests.begin(), requests.end(), [&](const CubeRequest& one) { return one.cube == cube; });
      const LayerTextures::SceneTexture& texture = layer_textures_.scene_texture(cube);
      const bool same = list.changes != 0 && texture.changes == list.changes;
      const bool fresh =
          texture.drawn && texture.request == cube->request && (cube->update == Update::next_frame_only || same);
      if (!known && !fresh) requests.push_back({cube, glm::dvec3(item.world_from_node[3])});
    }
  }
  return requests;
}

LayerTextures::SceneTexture& MeshPass::begin_cube(const CubeRequest& request, const RenderList& list) {
  LayerTextures::SceneTexture& texture = layer_textures_.scene_texture(request.cube);
  texture.drawn = true;
  texture.request = request.cube->request;
  texture.changes = list.changes;
  hidden_cube_ = request.cube.get();
  return texture;
}

}  // namespace gs::render
