#include "render/volume_rendering/volume_source.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

// Volume rendering styles of X3D 41.4 as GLSL.
namespace gs::render {
namespace {

using StepKind = VolumeStep::Kind;
using Weight = VolumeStep::Weight;

/// Code of a style. `$` is the number of the step, `@` the number of components of the voxels. Variables: `c`, colour
/// and opacity, input and output; `raw`, the components of the voxel; `n`, the unit normal in camera space and the
/// gradient per voxel; `to_viewer`; `place`, in camera space. `facing` is |n . V|, or 1 without a normal.
struct StyleRow {
  StepKind kind;
  bool normal, lights;
  std::string_view code;
};
constexpr std::array<StyleRow, 8> kStyles = {{
    // 41.4.7; without a transfer function, the default.
    {StepKind::opacity_map, false, false, "c = color_of(raw, @);"},
    // 41.4.2: values[0] is retainedOpacity, boundaryOpacity, opacityFactor.
    {StepKind::boundary, true, false,
     "c.a = min(c.a * (values_$[0].x + values_$[0].y * pow(max(n.w, 1e-6), values_$[0].z)), 1.0);"},
    // 41.4.5: edgeColor; values[1].x is the cosine of gradientThreshold.
    {StepKind::edge, true, false, "if (facing < values_$[1].x) c.rgb = mix(values_$[0].rgb, c.rgb, facing);"},
    // 41.4.12: warmColor, coolColor.
    {StepKind::tone, true, true, "c.rgb = toned(n.xyz, place, values_$[0].rgb, values_$[1].rgb);"},
    // 41.4.11: silhouetteRetainedOpacity, silhouetteBoundaryOpacity, silhouetteSharpness.
    {StepKind::silhouette, true, false,
     "c.a = min(c.a * (values_$[0].x + values_$[0].y * pow(max(1.0 - facing, 1e-6), values_$[0].z)), 1.0);"},
    // 41.4.3: the colours by ascending angle between the normal and the direction to the viewer.
    {StepKind::cartoon, true, false,
     "float ahead_$ = dot(n.xyz, to_viewer); if (ahead_$ <= 0.0) return vec4(0.0);"
     " c.rgb = values_$[min(int(acos(min(ahead_$, 1.0)) * 0.636619772 * float(COUNT_$)), COUNT_$ - 1)].rgb;"},
    // 41.4.10: diffuse colour and transparency, emissive colour and ambientIntensity, specular colour and exponent.
    {StepKind::shaded, true, true, ""},
    {StepKind::blend, false, false, ""},  // 41.4.1: values[0] is both constants
}};

const StyleRow& row_of(StepKind kind) { return kStyles[static_cast<std::size_t>(kind)]; }

/// Replaces each `$` by the number of a step, and each `@` by a number of components.
std::string numbered_code(std::string_view code, std::size_t number, std::size_t components = 1) {
  std::string text;
  for (const char c : code)
    c == '$' || c == '@' ? (void)(text += std::to_string(c == '$' ? number : components)) : text.push_back(c);
  return text;
}

bool has_lights(const VolumeStep& step) { return step.kind == StepKind::shaded ? step.lit : row_of(step.kind).lights; }

bool has_normal(const VolumeStep& step) { return step.kind == StepKind::shaded ? step.lit : row_of(step.kind).normal; }

/// Returns GLSL of a weight, an index in the tables of the step (X3D Tables 41.3 and 41.4).
std::string weight_code(const VolumeStep& step, std::size_t which) {
  static constexpr std::array<std::string_view, 6> kWeights = {"", "c.a", "d.a", "1.0 - c.a", "1.0 - d.a", ""};
  const Weight weight = step.weights[which];
  const std::string constant = which == 0 ? "values_$[0].x" : "values_$[0].y";
  if (weight == Weight::constant) return constant;
  if (weight != Weight::table) return std::string(kWeights[static_cast<std::size_t>(weight)]);
  if (!step.tables[which]) return which == 0 ? "c.a" : "d.a";
  return which == 0 ? "texture(table_$_0, vec2(c.a, d.a)).r" : "texture(table_$_1, vec2(d.a, c.a)).r";
}

// `shadow` is the number of the case of opacity_at() for shadows; nullopt if no voxel shades another one.
std::string shaded_code(const VolumeStep& step, std::optional<std::size_t> shadow) {
  const std::string_view diffuse = step.has_material ? "values_$[0].rgb" : "c.rgb";
  std::string code = "c = vec4(";
  if (step.lit) {
    code.append("shaded(n, place, to_viewer, ").append(diffuse).append(", values_$[1], values_$[2], ");
    code.append(step.scatters ? "1.0, " : "0.0, ").append(shadow ? std::to_string(*shadow) : "-1").append(", p)");
  } else {
    code.append(diffuse);
  }
  return code + ", c.a * (1.0 - values_$[0].w));";
}

/// Writer of the functions of a look. Numbers the steps.
class SourceWriter {
 public:
  /// If `shadows`, voxels shade others where their style asks for it.
  SourceWriter(VolumeSource& source, bool shadows) : source_(source), shadows_(shadows) {}

  /// Writes the function `name` of a chain: vec4 name(vec4 c, vec4 raw, vec3 p, vec3 place, vec3 to_viewer).
  /// `gradients` is the texture with the gradients of its volume.
  void chain(const std::string& name, const std::vector<VolumeStep>& steps, const std::string& gradients,
             std::size_t components) {
    std::string body;
    bool known_normal = false, opaque = false;
    const bool is_inner = std::exchange(in_chain_, true);
    std::string opacity;  // code of the transfer functions so far, for shadows
    for (const VolumeStep& step : steps) {
      const std::size_t number = next_++;
      declare(step, number);
      std::optional<std::size_t> shadow;
      if (shadows_ && !is_inner && step.kind == StepKind::shaded && step.lit && step.shadows) {
        shadow = number;
        shadow_cases_ +=
            numbered_code("  if (number == $) { " + opacity + " return c.a * (1.0 - values_$[0].w); }\n", number);
      }
      // Styles only scale an opacity. So an invisible voxel stays invisible, except in blends.
      if (!opaque && step.kind != StepKind::opacity_map && !has_blend(steps)) {
        body += "  if (c.a <= 0.0) return vec4(0.0);\n";
        opaque = true;
      }
      if (has_normal(step)) {
        const std::string call =
            step.normals ? numbered_code("given_normal(normals_$, p)", number) : "normal_at(" + gradients + ", p)";
        if (step.normals || !known_normal) {
          body += "  n = " + call + ";\n  facing = n.w > 0.0 ? abs(dot(n.xyz, to_viewer)) : 1.0;\n";
          known_normal = !step.normals;
        }
      }
      source_.lights = source_.lights || has_lights(step);
      const std::string code = step.kind == StepKind::shaded ? shaded_code(step, shadow) : code_of(step, number);
      body += "  " + numbered_code(code, number, components) + "\n";
      if (step.kind == StepKind::opacity_map) opacity += numbered_code(code, number, components) + " ";
    }
    in_chain_ = is_inner;
    source_.code += "vec4 " + name + "(vec4 c, vec4 raw, vec3 p, vec3 place, vec3 to_viewer) {\n";
    source_.code += "  vec4 n = vec4(0.0);\n  float facing = 1.0;\n" + body + "  return c;\n}\n";
  }
  /// Writes opacity_at() if a style has shadows. Call it after all chains.
  void shadows() {
    if (shadow_cases_.empty()) return;
    source_.defines += "#define SHADOWS\n";
    source_.code +=
        "float opacity_at(int number, vec3 p) {\n  vec4 raw = voxel_at(p);\n  vec4 c = color_of(raw, COMPONENTS);\n" +
        shadow_cases_ + "  return 0.0;\n}\n";
  }

 private:
  static bool has_blend(const std::vector<VolumeStep>& steps) {
    return std::any_of(steps.begin(), steps.end(), [](const VolumeStep& step) { return step.kind == StepKind::blend; });
  }

  void declare(const VolumeStep& step, std::size_t number) {
    std::string text;
    if (!step.values.empty())
      text += "#define COUNT_$ " + std::to_string(step.values.size()) + "\nuniform vec4 values_$[COUNT_$];\n";
    if (step.normals) text += "uniform sampler3D normals_$;\n";
    for (std::size_t i = 0; i < step.tables.size(); ++i)
      if (step.tables[i])
        text += std::string("uniform ") + (step.tables[i]->slices > 1 ? "sampler3D" : "sampler2D") + " table_$_" +
                std::to_string(i) + ";\n";
    if (step.voxels) text += "uniform sampler3D voxels_$;\n";
    if (step.voxels && needs_gradients(step)) text += "uniform sampler3D gradients_$;\n";
    source_.code += numbered_code(text, number);
  }

  std::string code_of(const VolumeStep& step, std::size_t number) {
    if (step.kind == StepKind::opacity_map && step.tables[0])
      return step.tables[0]->slices > 1 ? "c = texture(table_$_0, raw.xyz);" : "c = texture(table_$_0, raw.xy);";
    if (step.kind != StepKind::blend || !step.voxels) return std::string(row_of(step.kind).code);
    const std::string name = "second_" + std::to_string(number);
    chain(name, step.inner, numbered_code("gradients_$", number), step.voxels->components);
    const std::string components = std::to_string(step.voxels->components);
    return "{ vec4 other = components_of(texture(voxels_$, p), " + components + "); vec4 d = " + name +
           "(color_of(other, " + components +
           "), other, p, place, to_viewer);\n    float w1 = " + weight_code(step, 0) +
           ", w2 = " + weight_code(step, 1) + "; c = clamp(c * w1 + d * w2, 0.0, 1.0); }";
  }

  VolumeSource& source_;
  bool shadows_, in_chain_ = false;
  std::size_t next_ = 0;
  std::string shadow_cases_;
};

void add_steps(const std::vector<VolumeStep>& steps, std::vector<const VolumeStep*>& to) {
  for (const VolumeStep& step : steps) {
    to.push_back(&step);
    add_steps(step.inner, to);
  }
}

bool any_needs_gradients(const std::vector<VolumeStep>& steps) {
  return std::any_of(steps.begin(), steps.end(),
                     [](const VolumeStep& step) { return has_normal(step) && !step.normals; });
}

}  // namespace

std::vector<const VolumeStep*> numbered_steps(const VolumeLook& look) {
  std::vector<const VolumeStep*> steps;
  for (const VolumeChain& chain : look.chains) add_steps(chain.steps, steps);
  return steps;
}

bool needs_gradients(const VolumeStep& step) { return any_needs_gradients(step.inner); }

bool needs_gradients(const VolumeLook& look) {
  return look.iso_surfaces || std::any_of(look.chains.begin(), look.chains.end(),
                                          [](const VolumeChain& chain) { return any_needs_gradients(chain.steps); });
}

VolumeSource volume_source(const VolumeLook& look) {
  VolumeSource source;
  SourceWriter writer(source, !look.iso_surfaces);
  const std::uint32_t components = look.voxels ? look.voxels->components : 1;
  for (std::size_t i = 0; i < look.chains.size(); ++i)
    writer.chain("chain_" + std::to_string(i), look.chains[i].steps, "gradients", components);
  writer.shadows();
  // Selects the chain of a voxel. `projected` is set if the voxel takes part in the projection.
  source.code += "vec4 chain(int which, vec4 c, vec4 raw, vec3 p, vec3 place, vec3 to_viewer, out bool projected) {\n";
  source.code += "  projected = false;\n";
  bool projects = false;
  for (std::size_t i = 0; i < look.chains.size(); ++i) {
    const std::string number = std::to_string(i);
    const bool only = look.chains.size() == 1 && !look.segments;
    const bool projected = look.chains[i].projected && !look.iso_surfaces;
    projects = projects || projected;
    source.code += only ? "  {" : "  if (which == " + number + ") {";
    if (projected) source.code += " projected = true;";
    source.code += " return chain_" + number + "(c, raw, p, place, to_viewer); }\n";
  }
  source.code += "  return c;\n}\n";
  source.defines += "#define COMPONENTS " + std::to_string(components) + "\n";
  if (needs_gradients(look)) source.defines += "#define GRADIENTS\n";
  if (look.gradients) source.defines += "#define GIVEN_GRADIENTS\n";
  if (look.segments) source.defines += "#define SEGMENTS\n";
  if (projects) {
    static constexpr std::array<std::string_view, 3> kProjections = {"MAXIMUM", "MINIMUM", "AVERAGE"};
    source.defines.append("#define PROJECTION\n#define ")
        .append(kProjections[static_cast<std::size_t>(look.projection)])
        .append("\n");
    if (look.threshold > 0) source.defines += "#define THRESHOLD\n";
    if (look.projection_colors) source.defines += "#define PROJECTION_COLORS\n";
  }
  if (look.iso_surfaces)
    source.defines += "#define SURFACES " + std::to_string(std::max<std::size_t>(look.surfaces.size(), 1)) + "\n";
  return source;
}

}  // namespace gs::render
