#pragma once

// GLSL of layered materials (render/scene/layered_material.h). layered_program.cpp adds the code of the layers.
namespace gs::render {

/// Physical reflection (X3D 4 17.2.2.6, glTF 2.0 Appendix B) for kLightingShader. A light of intensity 1 is an irradiance
/// of 1, of which a white diffuse surface reflects 1 / pi to the viewer. `specular.rgb` is the reflectance at normal
/// incidence, `w` the roughness.
inline constexpr char kPhysicalShader[] = R"glsl(
vec3 physical(vec3 n, vec3 l, vec3 to_viewer, vec3 diffuse, vec4 specular) {
  float n_l = max(dot(n, l), 0.0), n_v = max(dot(n, to_viewer), 1e-4);
  vec3 h = l + to_viewer;
  h *= inversesqrt(max(dot(h, h), 1e-30));
  float n_h = clamp(dot(n, h), 0.0, 1.0), v_h = clamp(dot(to_viewer, h), 0.0, 1.0);
  float alpha = max(specular.w * specular.w, 2e-3), square = alpha * alpha;
  float spread = (n_h * square - n_h) * n_h + 1.0;
  float distribution = square / (spread * spread);
  float visibility = 0.5 / max(n_l * sqrt(n_v * n_v * (1.0 - square) + square) +
                               n_v * sqrt(n_l * n_l * (1.0 - square) + square), 1e-5);
  vec3 fresnel = specular.rgb + (1.0 - specular.rgb) * pow(1.0 - v_h, 5.0);
  const float kOneByPi = 0.318309886;
  return n_l * kOneByPi * (diffuse * (1.0 - fresnel) + fresnel * (distribution * visibility));
}
)glsl";

/// Vertex shader of layered materials, after kMeshAttributesShader. Defines: NORMALS; LOCAL: positions and normals of the mesh;
/// SET0 to SET4: sets of texture coordinates; TEXTURE: the only set; STYLE, after kStyleVertexShader.
inline constexpr char kLayeredVertexShader[] = R"glsl(
#ifdef SET0
layout(location = 10) in vec4 coordinate_set0;
out vec4 set0;
#endif
#ifdef SET1
layout(location = 11) in vec4 coordinate_set1;
out vec4 set1;
#endif
#ifdef SET2
layout(location = 12) in vec4 coordinate_set2;
out vec4 set2;
#endif
#ifdef SET3
layout(location = 13) in vec4 coordinate_set3;
out vec4 set3;
#endif
#ifdef SET4
layout(location = 14) in vec4 coordinate_set4;
out vec4 set4;
#endif
out vec4 surface_color;
flat out float has_color;
out vec3 camera_position;
flat out vec4 emissive_ambient;
flat out vec4 specular_exponent;
#ifdef NORMALS
out vec3 camera_normal;
#endif
#ifdef LOCAL
out vec3 local_position;
#ifdef NORMALS
out vec3 local_normal;
#endif
uniform vec3 mesh_origin;
#endif
#ifdef TEXTURE
out vec2 texture_place;
#endif

invariant gl_Position;
void main() {
  vec4 p = vec4(position, 1.0);
  vec3 place = vec3(dot(camera_from_node_x, p), dot(camera_from_node_y, p), dot(camera_from_node_z, p));
  gl_Position = clip_from_camera * vec4(place, 1.0);
  surface_color = color.w > 0.0 ? vec4(color.rgb, color.w < 2.0 ? base.a : color.w - 2.0) : base;
#ifdef STYLE
  apply_style(place, 0.0);
#endif
  has_color = color.w;
  camera_position = place;
  emissive_ambient = emissive;
  specular_exponent = specular;
#ifdef NORMALS
  camera_normal = normal_in_camera();
#endif
#ifdef LOCAL
  local_position = position + mesh_origin;
#ifdef NORMALS
  local_normal = normal;
#endif
#endif
#ifdef TEXTURE
  texture_place = texture_coordinate;
#endif
#ifdef SET0
  set0 = coordinate_set0;
#endif
#ifdef SET1
  set1 = coordinate_set1;
#endif
#ifdef SET2
  set2 = coordinate_set2;
#endif
#ifdef SET3
  set3 = coordinate_set3;
#endif
#ifdef SET4
  set4 = coordinate_set4;
#endif
}
)glsl";

/// Inputs and functions of the fragment shader of layered materials, before the code of the layers.
inline constexpr char kLayeredFragmentInputs[] = R"glsl(
#ifdef SET0
in vec4 set0;
#endif
#ifdef SET1
in vec4 set1;
#endif
#ifdef SET2
in vec4 set2;
#endif
#ifdef SET3
in vec4 set3;
#endif
#ifdef SET4
in vec4 set4;
#endif
in vec4 surface_color;
flat in float has_color;
in vec3 camera_position;
flat in vec4 emissive_ambient;
flat in vec4 specular_exponent;
#ifdef NORMALS
in vec3 camera_normal;
#endif
#ifdef LOCAL
in vec3 local_position;
#ifdef NORMALS
in vec3 local_normal;
#endif
#endif
#ifdef TEXTURE
in vec2 texture_place;
#endif
uniform mat3 world_from_camera;
uniform vec4 factor;           // color and alpha of the MultiTexture
uniform vec4 amounts;          // normalScale, occlusionStrength, alphaCutoff
uniform vec2 metal_roughness;  // of the front
#ifdef BACK
uniform vec4 back_main, back_emissive, back_specular;
uniform vec2 back_metal_roughness;
#endif
out vec4 result;

vec3 unit(vec3 v) { return v * inversesqrt(max(dot(v, v), 1e-30)); }

vec3 surface_normal() {
#ifdef NORMALS
  vec3 n = unit(camera_normal);
  return gl_FrontFacing ? n : -n;
#else
  return unit(cross(dFdx(camera_position), dFdy(camera_position)));  // points towards the viewer
#endif
}

#ifdef LOCAL
vec3 normal_of_mesh() {
#ifdef NORMALS
  return gl_FrontFacing ? unit(local_normal) : -unit(local_normal);
#else
  return unit(cross(dFdx(local_position), dFdy(local_position)));
#endif
}
#endif

// Returns the normal that a normal map gives, from the derivatives of the texture coordinates.
vec3 mapped_normal(vec3 n, vec3 texel, vec2 at, float scale) {
  vec3 right = dFdx(camera_position), up = dFdy(camera_position);
  vec2 at_right = dFdx(at), at_up = dFdy(at);
  float area = at_right.x * at_up.y - at_up.x * at_right.y;
  if (abs(area) < 1e-20) return n;
  vec3 tangent = unit((right * at_up.y - up * at_right.y) / area);
  tangent = unit(tangent - n * dot(n, tangent));
  vec3 bitangent = (up * at_right.x - right * at_up.x) / area;
  vec3 other = cross(n, tangent);
  if (dot(other, bitangent) < 0.0) other = -other;
  vec3 bent = texel * 2.0 - 1.0;
  bent.xy *= scale;
  return unit(tangent * bent.x + other * bent.y + n * bent.z);
}

#ifdef NOISE
float random(vec3 p) { return fract(sin(dot(p, vec3(12.9898, 78.233, 37.719))) * 43758.5453); }
float smooth_random(vec3 p) {
  vec3 whole = floor(p), part = p - whole;
  part = part * part * (3.0 - 2.0 * part);
  vec4 near = vec4(random(whole), random(whole + vec3(1, 0, 0)), random(whole + vec3(0, 1, 0)),
                   random(whole + vec3(1, 1, 0)));
  vec4 far = vec4(random(whole + vec3(0, 0, 1)), random(whole + vec3(1, 0, 1)), random(whole + vec3(0, 1, 1)),
                  random(whole + vec3(1, 1, 1)));
  vec4 mean = mix(near, far, part.z);
  vec2 row = mix(mean.xy, mean.zw, part.y);
  return mix(row.x, row.y, part.x) * 2.0 - 1.0;
}
vec3 noise_at(vec3 p) {
  return vec3(smooth_random(p), smooth_random(p + vec3(31.4, 0, 0)), smooth_random(p + vec3(0, 57.1, 0)));
}
#endif
#ifdef PHYSICAL
vec3 linear(vec3 display) { return pow(max(display, 0.0), vec3(2.2)); }
vec3 displayed(vec3 color) { return pow(clamp(color, 0.0, 1.0), vec3(1.0 / 2.2)); }
#else
vec3 linear(vec3 display) { return display; }
vec3 displayed(vec3 color) { return color; }
#endif
)glsl";

/// Main function of the fragment shader, up to the code of the layers.
inline constexpr char kLayeredFragmentBegin[] = R"glsl(
void main() {
  vec4 color = surface_color, emission = emissive_ambient, specular = specular_exponent;
  vec2 metal = metal_roughness;
#ifdef BACK
  if (!gl_FrontFacing) {
    color = has_color > 0.0 ? vec4(surface_color.rgb, has_color < 2.0 ? back_main.a : surface_color.a) : back_main;
    emission = back_emissive;
    specular = back_specular;
    metal = back_metal_roughness;
  }
#endif
  vec4 diffuse = color;
  vec3 n = surface_normal(), ambient_tint = vec3(1.0);
  float occlusion = 1.0;
)glsl";

/// Main function of the fragment shader, after the code of the layers.
inline constexpr char kLayeredFragmentEnd[] = R"glsl(
#ifdef CUT_OUT
#ifdef SMOOTH_EDGES
  color.a = clamp((color.a - amounts.z) / max(fwidth(color.a), 0.004) + 0.5, 0.0, 1.0);
#else
  if (color.a < amounts.z) discard;
#endif
#endif
#ifdef OPAQUE
  color.a = 1.0;
#endif
#ifdef LIT
#ifdef PHYSICAL
  vec4 reflectance = vec4(mix(vec3(0.04), color.rgb, metal.x), metal.y);
  vec3 shaded = lit_parts(n, camera_position, color.rgb * (1.0 - metal.x), vec3(0.0), color.rgb, reflectance);
#else
  vec3 shaded = lit_parts(n, camera_position, color.rgb, vec3(0.0), color.rgb * ambient_tint * emission.w, specular);
#endif
  color.rgb = displayed(shaded * mix(1.0, occlusion, amounts.y) + emission.rgb);
#endif
#ifdef STYLE
  color = styled(color, camera_position);
#elif defined(FOG)
  color.rgb = fogged(color.rgb, camera_position);
#endif
  result = color;
}
)glsl";

}  // namespace gs::render
