#include "render/gl/layered_program.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

namespace gs::render {
namespace {

using Layer = TextureLayer;
using Coordinates = TextureLayer::Coordinates;

/// Sources of texture coordinates, in the order of Coordinates. `$` is the number of the layer. Empty for the mesh.
struct CoordinateRow {
  std::string_view code;
  bool local = false, normal = false, noise = false;
};
constexpr std::array<CoordinateRow, 14> kCoordinateCode = {{
    {""},
    {"vec4(local_position, 1.0)", true},
    {"vec4(n.xy * 0.5 + 0.5, 0.0, 1.0)", false, true},
    {"vec4(n, 1.0)", false, true},
    {"vec4(camera_position, 1.0)"},
    {"vec4(reflect(unit(camera_position), n), 1.0)", false, true},
    {"vec4(world_from_camera * n, 1.0)", false, true},
    {"vec4(world_from_camera * reflect(unit(camera_position), n), 1.0)", false, true},
    {"vec4(normal_of_mesh().xy * 0.5 + 0.5, 0.0, 1.0)", true, true},
    {"vec4(local_position, 1.0)", true},
    {"vec4(noise_at(local_position * generator_$[0] + generator_$[1]), 1.0)", true, false, true},
    {"vec4(noise_at(camera_position * generator_$[0] + generator_$[1]), 1.0)", false, false, true},
    {"vec4(generator_$[0].x > 0.0 ? refract(unit(camera_position), n, generator_$[0].x)"
     " : reflect(unit(camera_position), n), 1.0)",
     false, true},
    {"vec4(generator_$[0].x > 0.0 ?"
     " refract(unit(local_position - vec3(generator_$[0].yz, generator_$[1].x)), normal_of_mesh(), generator_$[0].x) :"
     " reflect(unit(local_position - vec3(generator_$[0].yz, generator_$[1].x)), normal_of_mesh()), 1.0)",
     true, true},
}};

/// Blending operations in the order of Layer::Mode (X3D Table 18.3): of the colours, and of alpha. `a` is the texture,
/// `b` the second argument.
struct ModeRow {
  std::string_view color, alpha;
};
constexpr std::array<ModeRow, 20> kModeCode = {{
    {"a.rgb * b.rgb", "a.a * b.a"},
    {"a.rgb", "a.a"},
    {"a.rgb * b.rgb * 2.0", "a.a * b.a * 2.0"},
    {"a.rgb * b.rgb * 4.0", "a.a * b.a * 4.0"},
    {"a.rgb + b.rgb", "a.a + b.a"},
    {"a.rgb + b.rgb - 0.5", "a.a + b.a - 0.5"},
    {"(a.rgb + b.rgb - 0.5) * 2.0", "(a.a + b.a - 0.5) * 2.0"},
    {"a.rgb - b.rgb", "a.a - b.a"},
    {"a.rgb + (1.0 - a.rgb) * b.rgb", "a.a + (1.0 - a.a) * b.a"},
    {"mix(b.rgb, a.rgb, diffuse.a)", "mix(b.a, a.a, diffuse.a)"},
    {"mix(b.rgb, a.rgb, a.a)", "mix(b.a, a.a, a.a)"},
    {"mix(b.rgb, a.rgb, factor.a)", "mix(b.a, a.a, factor.a)"},
    {"mix(b.rgb, a.rgb, color.a)", "mix(b.a, a.a, color.a)"},
    {"a.rgb + a.a * b.rgb", "a.a + a.a * b.a"},
    {"a.rgb + (1.0 - a.a) * b.rgb", "a.a + (1.0 - a.a) * b.a"},
    {"(1.0 - a.rgb) * b.rgb + a.a", "(1.0 - a.a) * b.a + a.a"},
    {"vec3(4.0 * dot(a.rgb - 0.5, b.rgb - 0.5))", "4.0 * dot(a.rgb - 0.5, b.rgb - 0.5)"},
    {"a.rgb", "a.a"},
    {"b.rgb", "b.a"},
    {"color.rgb", "color.a"},
}};

/// GLSL code for each Layer::Target, in the order of the enumerators; empty for stages. `t` is the texel.
constexpr std::array<std::string_view, 9> kTargetCode = {
    "",
    "color = vec4(color.rgb * linear(t.rgb), color.a * t.a);",
    "ambient_tint *= t.rgb;",
    "emission.rgb *= linear(t.rgb);",
    "specular.rgb *= t.rgb;",
    "specular.w *= t.a;",
    "n = mapped_normal(n, t.rgb, coordinate_$(n).xy, amounts.x);",
    "occlusion *= t.r;",
    "metal *= t.bg;",
};

constexpr std::array<std::string_view, 4> kSamplerTypes = {"sampler2D", "sampler3D", "samplerCube", "samplerCube"};
constexpr std::array<std::string_view, 4> kTexelCode = {
    "texture(layer_$, vec2(c.x / c.w, 1.0 - c.y / c.w))", "texture(layer_$, vec3(c.x, c.w - c.y, c.z) / c.w)",
    // OpenGL's cubes are left-handed.
    "texture(layer_$, c.xyz * vec3(1.0, 1.0, -1.0))", "texture(layer_$, c.xyz)"};

template <class E>
std::size_t at(E value) {
  return static_cast<std::size_t>(value);
}

/// Replaces each `$` by the number of the layer.
std::string numbered(std::string_view code, std::size_t layer) {
  std::string text;
  for (const char c : code) c == '$' ? (void)(text += std::to_string(layer)) : text.push_back(c);
  return text;
}

bool uses_set(const Layer& layer) { return layer.coordinates == Coordinates::mesh; }

std::string stage_of(const Layer& layer) {
  static constexpr std::array<std::string_view, 4> kSourceCode = {"color", "diffuse", "vec4(specular.rgb, color.a)",
                                                                  "factor"};
  std::string text = "vec4 a = vec4(linear(t.rgb), t.a), b = ";
  text.append(kSourceCode[at(layer.source)]).append("; color = clamp(vec4(");
  text.append(kModeCode[at(layer.color_mode)].color).append(", ").append(kModeCode[at(layer.alpha_mode)].alpha);
  text.append("), 0.0, 1.0);");
  if (layer.function == Layer::Function::complement) text += " color.rgb = 1.0 - color.rgb;";
  if (layer.function == Layer::Function::alpha_replicate) text += " color.rgb = vec3(color.a);";
  return text;
}

}  // namespace

std::string layered_key(const LayeredMaterial& material) {
  std::string key;
  const auto add = [&](auto value) { key.push_back(static_cast<char>('0' + static_cast<int>(value))); };
  add(material.model);
  add(material.has_back);
  add(material.alpha_mode == LayeredMaterial::AlphaMode::opaque);
  for (const Layer& layer : material.layers) {
    add(layer.kind);
    add(layer.target);
    add(layer.coordinates);
    add(layer.set);
    add(layer.color_mode);
    add(layer.alpha_mode);
    add(layer.source);
    add(layer.function);
  }
  return key;
}

LayeredSource layered_source(const LayeredMaterial& material, std::size_t sets) {
  LayeredSource source;
  bool local = false, noise = false, uv = false;
  std::set<std::size_t> used;
  // Normal maps come last, because generated coordinates depend on the normal of the surface.
  std::string late;
  for (std::size_t i = 0; i < material.layers.size(); ++i) {
    const Layer& layer = material.layers[i];
    const CoordinateRow& row = kCoordinateCode[at(layer.coordinates)];
    local = local || row.local;
    noise = noise || row.noise;
    std::string from(row.code);
    if (uses_set(layer)) {
      const std::size_t set = std::min<std::size_t>(layer.set, std::max<std::size_t>(sets, 1) - 1);
      if (sets > 0) used.insert(set);
      uv = uv || sets == 0;
      from = sets > 0 ? "set" + std::to_string(set) : "vec4(texture_place, 0.0, 1.0)";
    }
    std::string code("uniform ");
    code.append(kSamplerTypes[at(layer.kind)])
        .append(" layer_$;\nuniform mat4 transform_$;\nuniform vec3 generator_$[2];\n");
    code.append("vec4 coordinate_$(vec3 n) { return transform_$ * ").append(from).append("; }\n");
    code.append("vec4 texel_$(vec3 n) { vec4 c = coordinate_$(n); return ").append(kTexelCode[at(layer.kind)]);
    source.layers += numbered(code + "; }\n", i);
    const std::string effect =
        "  { vec4 t = texel_$(n); " +
        (layer.target == Layer::Target::stage ? stage_of(layer) : std::string(kTargetCode[at(layer.target)])) + " }\n";
    (layer.target == Layer::Target::normal ? late : source.apply) += numbered(effect, i);
  }
  source.apply += late;
  if (uv) source.defines += "#define TEXTURE\n";
  if (local) source.defines += "#define LOCAL\n";
  if (noise) source.defines += "#define NOISE\n";
  for (const std::size_t set : used) source.defines += "#define SET" + std::to_string(set) + "\n";
  if (material.model == LayeredMaterial::Model::physical) source.defines += "#define PHYSICAL\n";
  if (material.has_back) source.defines += "#define BACK\n";
  if (material.alpha_mode == LayeredMaterial::AlphaMode::opaque) source.defines += "#define OPAQUE\n";
  return source;
}

bool needs_normals(const LayeredMaterial& material) {
  return std::any_of(material.layers.begin(), material.layers.end(),
                     [](const Layer& layer) { return kCoordinateCode[at(layer.coordinates)].normal; });
}

bool needs_coordinates(const LayeredMaterial& material) {
  return std::any_of(material.layers.begin(), material.layers.end(), uses_set);
}

}  // namespace gs::render
