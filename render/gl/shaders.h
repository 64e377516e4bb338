#pragma once

// GLSL 3.30 without the #version line; make_program adds it together with the #defines.
namespace gs::render {

/// Lighting equation of VRML97 4.14.4 in camera space, for the fragment stage of lit variants. Defines: LOCAL_LIGHTS
/// (point and spot lights), SPECULAR, EMISSIVE (emissive and ambient parts), and those of LightSets: MANY_LIGHTS, or
/// MOST_LIGHTS and ALL_LIGHTS ("ADD(0) ADD(1)") for a fixed number of lights; otherwise the set gives the number. A
/// software driver draws one or two lights faster with constant numbers, but takes 0.1 s to compile each; a loop over
/// any number of lights compiles as fast as two.
inline constexpr char kLightingShader[] = R"glsl(
struct Light {
  vec4 location_local;
  vec4 color_intensity;
  vec4 direction_ambient;
  vec4 attenuation_radius;
  vec4 cone;
};
#ifdef MANY_LIGHTS
uniform samplerBuffer many_lights;  // the same, in texels
uniform int first_light;
Light light_at(int i) {
  int at = first_light + 1 + 5 * i;
  return Light(texelFetch(many_lights, at), texelFetch(many_lights, at + 1), texelFetch(many_lights, at + 2),
               texelFetch(many_lights, at + 3), texelFetch(many_lights, at + 4));
}
#else
layout(std140) uniform Lights {
  int light_count;
  Light lights[MOST_LIGHTS];
};
#define light_at(i) lights[i]
#endif

// Returns the contribution of one light.
vec3 reflected(Light light, vec3 n, vec3 place, vec3 to_viewer, vec3 diffuse, vec3 ambient, vec4 specular_exponent) {
  vec3 l = light.location_local.xyz;
  float strength = 1.0;
#ifdef LOCAL_LIGHTS
  // Without branches, which cost software drivers more than the work: directional lights come with numbers that change
  // nothing, and point lights with those of a cone that is wider than a sphere.
  l -= light.location_local.w * place;
  float distance = length(l);
  l /= max(distance, 1e-30);
  vec3 c = light.attenuation_radius.xyz;
  strength = 1.0 / max(c.x + distance * (c.y + distance * c.z), 1.0);
  float angle = acos(clamp(dot(-l, light.direction_ambient.xyz), -1.0, 1.0));
  strength *= clamp((light.cone.x - angle) * light.cone.y, 0.0, 1.0);
  strength = distance > light.attenuation_radius.w ? 0.0 : strength;
#endif
  float intensity = light.color_intensity.w;
  vec3 sum = light.direction_ambient.w * ambient + intensity * max(dot(n, l), 0.0) * diffuse;
#ifdef SPECULAR
  vec3 h = l + to_viewer;
  float cosine = max(dot(n, h) * inversesqrt(max(dot(h, h), 1e-30)), 0.0);
  // 0 to the power 0 is undefined in GLSL and 1 in the equation.
  float highlight = specular_exponent.w > 0.0 ? pow(cosine, specular_exponent.w) : 1.0;
  sum += intensity * highlight * specular_exponent.rgb;
#endif
  return strength * light.color_intensity.rgb * sum;
}

uniform float eye_back;  // how far behind the viewer his eye is: far away where rays are parallel

vec3 lit(vec3 n, vec3 place, vec3 diffuse, vec4 emissive_ambient, vec4 specular_exponent) {
  vec3 ambient = diffuse * emissive_ambient.w;
  vec3 sum = emissive_ambient.rgb, to_viewer = normalize(vec3(0.0, 0.0, eye_back) - place);  // once: drivers leave it in the loop
#define ADD(i) sum += reflected(light_at(i), n, place, to_viewer, diffuse, ambient, specular_exponent);
#ifdef ALL_LIGHTS
  ALL_LIGHTS
#else
#ifdef MANY_LIGHTS
  int light_count = int(texelFetch(many_lights, first_light).y);
#endif
  // At least one light, and the test behind it: llvmpipe would go through a loop of n lights n + 1 times.
  int i = 0;
  do {
    ADD(i)
  } while (++i < light_count);
#endif
  return sum;
}
)glsl";

/// Fog of VRML97 4.14.4 and Table 4.8 in camera space, for the fragment stage. FogUniforms sets it.
inline constexpr char kFogShader[] = R"glsl(
uniform mat3 fog_ranges;  // the Fog's own space, in visibilityRanges
uniform vec4 fog_color;   // w: 1 where fogType is EXPONENTIAL
uniform float fog_back;   // how far before the camera the viewer is
vec3 fogged(vec3 color, vec3 place) {
  vec3 away = fog_ranges * (place + vec3(0.0, 0.0, fog_back));
  float ranges = min(sqrt(dot(away, away)), 1.0);
  float interpolant = fog_color.w > 0.0 ? exp(-ranges / max(1.0 - ranges, 1e-6)) : 1.0 - ranges;
  return mix(fog_color.rgb, color, interpolant);
}
)glsl";

/// Vertex shader of meshes. Defines: LIT, NORMALS, TEXTURE, FOG; LOCAL_LIGHTS, SPECULAR, EMISSIVE. Passes on only what
/// the fragments use, since software drivers store it for every triangle of a frame.
inline constexpr char kMeshVertexShader[] = R"glsl(
layout(location = 0) in vec3 position;
#ifdef NORMALS
layout(location = 1) in vec3 normal;
#endif
layout(location = 2) in vec4 color;  // w: 1, or 0 where the mesh has none
#ifdef TEXTURE
layout(location = 3) in vec2 texture_coordinate;
#endif
#if defined(FOG) || (defined(LIT) && (defined(LOCAL_LIGHTS) || defined(SPECULAR) || !defined(NORMALS)))
#define POSITION
#endif
layout(location = 4) in vec4 camera_from_node_x;
layout(location = 5) in vec4 camera_from_node_y;
layout(location = 6) in vec4 camera_from_node_z;
layout(location = 7) in vec4 base;
layout(location = 8) in vec4 emissive;
layout(location = 9) in vec4 specular;

uniform mat4 clip_from_camera;
uniform mat3 texture_transform;

#ifdef MASK
flat
#endif
out vec4 surface_color;
#ifdef POSITION
out vec3 camera_position;
#endif
#ifdef LIT
#ifdef EMISSIVE
flat out vec4 emissive_ambient;
#endif
#ifdef SPECULAR
flat out vec4 specular_exponent;
#endif
#ifdef NORMALS
out vec3 camera_normal;
#endif
#endif
#ifdef TEXTURE
out vec2 texture_place;
#endif

#ifdef NORMALS
// Normals go with the matrix of cofactors, which unlike the inverse exists for flattened shapes.
// Scaled first, so that the products of very small or large scales stay within float32.
vec3 normal_in_camera() {
  vec3 x = camera_from_node_x.xyz, y = camera_from_node_y.xyz, z = camera_from_node_z.xyz;
  vec3 largest = max(max(abs(x), abs(y)), abs(z));
  float scale = 1.0 / max(max(max(largest.x, largest.y), largest.z), 1e-37);
  x *= scale;
  y *= scale;
  z *= scale;
  vec3 yz = cross(y, z);
  vec3 n = vec3(dot(yz, normal), dot(cross(z, x), normal), dot(cross(x, y), normal));
  return dot(x, yz) < 0.0 ? -n : n;
}
#endif

// Faces in the same place have the same depths, whatever else is made of them.
invariant gl_Position;
void main() {
  vec4 p = vec4(position, 1.0);
  vec3 place = vec3(dot(camera_from_node_x, p), dot(camera_from_node_y, p), dot(camera_from_node_z, p));
  gl_Position = clip_from_camera * vec4(place, 1.0);
  surface_color = color.w > 0.0 ? vec4(color.rgb, base.a) : base;
#ifdef POSITION
  camera_position = place;
#endif
#ifdef LIT
#ifdef EMISSIVE
  emissive_ambient = emissive;
#endif
#ifdef SPECULAR
  specular_exponent = specular;
#endif
#ifdef NORMALS
  camera_normal = normal_in_camera();
#endif
#endif
#ifdef TEXTURE
  texture_place = (texture_transform * vec3(texture_coordinate, 1.0)).xy;
  texture_place.y = 1.0 - texture_place.y;  // rows of images come from the top, t = 0 is the bottom
#endif
}
)glsl";

/// Fragment shader of meshes. Defines: those of the vertex shader. With TEXTURE also CUT_OUT, which prevents an early
/// depth test; SMOOTH_EDGES, which turns alpha into sample coverage; and MASK, for faces of one colour that the texture
/// cuts out. Colours as in VRML97 Tables 4.5 and 4.6.
inline constexpr char kMeshFragmentShader[] = R"glsl(
#if defined(FOG) || (defined(LIT) && (defined(LOCAL_LIGHTS) || defined(SPECULAR) || !defined(NORMALS)))
#define POSITION
#endif
#ifdef MASK
flat
#endif
in vec4 surface_color;
#ifdef TEXTURE
in vec2 texture_place;
uniform sampler2D image;
uniform ivec2 replaces;  // 1 where the texture replaces the colour, the alpha
#endif
out vec4 result;

#ifdef POSITION
in vec3 camera_position;
#else
const vec3 camera_position = vec3(0.0);
#endif
#ifdef LIT
#ifdef EMISSIVE
flat in vec4 emissive_ambient;
#else
const vec4 emissive_ambient = vec4(0.0);
#endif
#ifdef SPECULAR
flat in vec4 specular_exponent;
#else
const vec4 specular_exponent = vec4(0.0);
#endif
#ifdef NORMALS
in vec3 camera_normal;
#endif

vec3 surface_normal() {
#ifdef NORMALS
  vec3 n = camera_normal * inversesqrt(max(dot(camera_normal, camera_normal), 1e-30));
  return gl_FrontFacing ? n : -n;
#else
  vec3 n = cross(dFdx(camera_position), dFdy(camera_position));  // towards the viewer
  return n * inversesqrt(max(dot(n, n), 1e-37));
#endif
}

#endif

void main() {
  vec4 color = surface_color;
#ifdef TEXTURE
  vec4 texel = texture(image, texture_place);
#ifndef MASK
  color.rgb = replaces.x != 0 ? texel.rgb : color.rgb * texel.rgb;
  if (replaces.y != 0) color.a = texel.a;
#endif
#ifdef CUT_OUT
#ifdef SMOOTH_EDGES
  // How much of the pixel is inside becomes that many of its samples.
  color.a *= clamp((texel.a - 0.5) / max(fwidth(texel.a), 0.004) + 0.5, 0.0, 1.0);
#else
  if (texel.a < 0.5) discard;
#endif
#endif
#endif
#ifdef LIT
  color.rgb = lit(surface_normal(), camera_position, color.rgb, emissive_ambient, specular_exponent);
#endif
#ifdef FOG
  color.rgb = fogged(color.rgb, camera_position);
#endif
  result = color;
}
)glsl";

/// One triangle that covers the viewport.
inline constexpr char kScreenVertexShader[] = R"glsl(
void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
  gl_Position = vec4(corner, 0.0, 1.0);
}
)glsl";

/// One triangle that covers the viewport, from gl_VertexID alone.
inline constexpr char kBackgroundVertexShader[] = R"glsl(
uniform mat3 background_from_camera;
uniform vec2 tangents, center;  // of half of the angles of view, and of what is in the middle
out vec3 ray;
void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
  ray = background_from_camera * vec3(corner * tangents + center, -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)glsl";

/// Spheres of VRML97 6.5. `rings` holds colour and angle of the sky's rings, then of the ground's.
inline constexpr char kBackgroundFragmentShader[] = R"glsl(
uniform sampler2D rings;
uniform ivec2 counts;  // sky, ground
in vec3 ray;
out vec4 result;

vec3 ring_color(int first, int count, float angle) {
  int low = 0, high = count - 1;  // the last ring with an angle that is not larger
  while (low < high) {
    int middle = (low + high + 1) / 2;
    if (texelFetch(rings, ivec2(first + middle, 0), 0).w <= angle) low = middle; else high = middle - 1;
  }
  vec4 inner = texelFetch(rings, ivec2(first + low, 0), 0);
  if (low == count - 1) return inner.rgb;
  vec4 outer = texelFetch(rings, ivec2(first + low + 1, 0), 0);
  return mix(inner.rgb, outer.rgb, clamp((angle - inner.w) / (outer.w - inner.w), 0.0, 1.0));
}

void main() {
  float from_zenith = atan(length(ray.xz), ray.y), from_nadir = 3.14159265 - from_zenith;
  float pixel = max(fwidth(from_nadir), 1e-6);
  vec3 color = ring_color(0, counts.x, from_zenith);
  if (counts.y > 1) {
    // One pass shades once a pixel, so the edge of the ground is smoothed here and not by samples.
    float last = texelFetch(rings, ivec2(counts.x + counts.y - 1, 0), 0).w;
    color = mix(color, ring_color(counts.x, counts.y, from_nadir), clamp((last - from_nadir) / pixel + 0.5, 0.0, 1.0));
  }
  result = vec4(color, 1.0);
}
)glsl";

/// Face of the panorama's cube (VRML97 6.5): four corners of a strip, infinitely far away.
inline constexpr char kPanoramaVertexShader[] = R"glsl(
uniform mat3 camera_from_face;  // to the right, up and ahead in the picture
uniform vec2 tangents, center;  // of half the angles of view, and of what is in the middle
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec3 ray = camera_from_face * vec3(corner * 2.0 - 1.0, 1.0);
  place = vec2(corner.x, 1.0 - corner.y);  // rows of images come from the top
  gl_Position = vec4((ray.xy + center * ray.z) / tangents, 0.0, -ray.z);
}
)glsl";

inline constexpr char kPanoramaFragmentShader[] = R"glsl(
uniform sampler2D image;
in vec2 place;
out vec4 result;
void main() {
  result = texture(image, place);
}
)glsl";

}  // namespace gs::render
