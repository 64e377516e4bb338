#pragma once

// GLSL 3.30 without the #version line. make_program adds that line and the #defines.
namespace gs::render {

/// Lighting equation of VRML97 4.14.4 in camera space, for the fragment shader of lit variants. Defines:
/// - LOCAL_LIGHTS: point and spot lights; SPECULAR; EMISSIVE: emissive and ambient parts;
/// - PHYSICAL: physical reflection (kPhysicalShader); `specular_exponent` is then reflectance and roughness;
/// - MANY_LIGHTS: lights in a buffer texture, otherwise in a uniform block;
/// - MOST_LIGHTS: size of the uniform block;
/// - ALL_LIGHTS: "ADD(0) ADD(1)" for a fixed number of lights. Without it, a loop reads the number from the set.
/// Software drivers draw one or two lights faster with a fixed number, but need 0.1 s to compile each variant. The loop
/// compiles as fast as two lights.
inline constexpr char kLightingShader[] = R"glsl(
struct Light {
  vec4 location_local;
  vec4 color_intensity;
  vec4 direction_ambient;
  vec4 attenuation_radius;
  vec4 cone;
};
#ifdef MANY_LIGHTS
uniform samplerBuffer many_lights;  // sets of lights in the layout of the block below
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

// Returns the light that the surface reflects from one light, in camera space.
vec3 reflected(Light light, vec3 n, vec3 place, vec3 to_viewer, vec3 diffuse, vec3 ambient, vec4 specular_exponent) {
  vec3 l = light.location_local.xyz;
  float strength = 1.0;
#ifdef LOCAL_LIGHTS
  // No branches: in software drivers they cost more than the computation. Directional lights have neutral values, and
  // point lights a cone that includes all directions.
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
#ifdef PHYSICAL
  vec3 sum = light.direction_ambient.w * ambient + intensity * physical(n, l, to_viewer, diffuse, specular_exponent);
#else
  vec3 sum = light.direction_ambient.w * ambient + intensity * max(dot(n, l), 0.0) * diffuse;
#ifdef SPECULAR
  vec3 h = l + to_viewer;
  float cosine = max(dot(n, h) * inversesqrt(max(dot(h, h), 1e-30)), 0.0);
  // GLSL does not define 0 to the power 0; the equation takes 1.
  float highlight = specular_exponent.w > 0.0 ? pow(cosine, specular_exponent.w) : 1.0;
  sum += intensity * highlight * specular_exponent.rgb;
#endif
#endif
  return strength * light.color_intensity.rgb * sum;
}

uniform float eye_back;  // distance of the eye behind the viewer, metres; very large in parallel projection

// Adds the light that the surface reflects to `sum`.
vec3 lit_parts(vec3 n, vec3 place, vec3 diffuse, vec3 sum, vec3 ambient, vec4 specular_exponent) {
  vec3 to_viewer = normalize(vec3(0.0, 0.0, eye_back) - place);  // hoisted by hand
#define ADD(i) sum += reflected(light_at(i), n, place, to_viewer, diffuse, ambient, specular_exponent);
#ifdef ALL_LIGHTS
  ALL_LIGHTS
#else
#ifdef MANY_LIGHTS
  int light_count = int(texelFetch(many_lights, first_light).y);
#endif
  // The set has at least one light, and the test is at the end: llvmpipe would run a `for` loop of n lights n + 1
  // times.
  int i = 0;
  do {
    ADD(i)
  } while (++i < light_count);
#endif
  return sum;
}

vec3 lit(vec3 n, vec3 place, vec3 diffuse, vec4 emissive_ambient, vec4 specular_exponent) {
  return lit_parts(n, place, diffuse, emissive_ambient.rgb, diffuse * emissive_ambient.w, specular_exponent);
}
)glsl";

/// Fog of VRML97 4.14.4 and Table 4.8 in camera space, for the fragment shader. FogUniforms sets its uniforms.
inline constexpr char kFogShader[] = R"glsl(
uniform mat3 fog_ranges;  // from camera space to the space of the Fog node, divided by visibilityRange
uniform vec4 fog_color;  // w: 1 if fogType is EXPONENTIAL
uniform float fog_back;  // distance of the viewer in front of the camera
// Returns the distance of a place from the viewer, in units of visibilityRange and at most 1.
float fog_distance(vec3 place) {
  vec3 away = fog_ranges * (place + vec3(0.0, 0.0, fog_back));
  return min(sqrt(dot(away, away)), 1.0);
}
vec3 fogged_at(vec3 color, float ranges) {
  float interpolant = fog_color.w > 0.0 ? exp(-ranges / max(1.0 - ranges, 1e-6)) : 1.0 - ranges;
  return mix(fog_color.rgb, color, interpolant);
}
vec3 fogged(vec3 color, vec3 place) { return fogged_at(color, fog_distance(place)); }
)glsl";

/// Attributes of a vertex of a mesh and of its instance, for vertex shaders of meshes. Defines: NORMALS, TEXTURE.
inline constexpr char kMeshAttributesShader[] = R"glsl(
layout(location = 0) in vec3 position;
#ifdef NORMALS
layout(location = 1) in vec3 normal;
#endif
layout(location = 2) in vec4 color;  // w: 0 without colours, 1 if alpha is that of the material, otherwise 2 + alpha
#if defined(TEXTURE) || defined(STYLE)
layout(location = 3) in vec2 texture_coordinate;
#endif
layout(location = 4) in vec4 camera_from_node_x;
layout(location = 5) in vec4 camera_from_node_y;
layout(location = 6) in vec4 camera_from_node_z;
layout(location = 7) in vec4 base;
layout(location = 8) in vec4 emissive;
layout(location = 9) in vec4 specular;

uniform mat4 clip_from_camera;

#ifdef NORMALS
// Transforms the normal by the matrix of cofactors. Unlike the inverse, this matrix exists for flattened shapes. Scales
// first, so that the products stay within float32.
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
)glsl";

/// Vertex shader of meshes, after kMeshAttributesShader. Defines: LIT, NORMALS, TEXTURE, FOG, LOCAL_LIGHTS, SPECULAR,
/// EMISSIVE. Outputs only values that the fragment shader uses, because software drivers store them for every triangle
/// of a frame.
inline constexpr char kMeshVertexShader[] = R"glsl(
#if defined(FOG) || (defined(LIT) && (defined(LOCAL_LIGHTS) || defined(SPECULAR) || !defined(NORMALS)))
#define POSITION
#endif
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
SAMPLED out vec2 texture_place;
#endif

// All variants must compute equal depths for coincident faces.
invariant gl_Position;
void main() {
  vec4 p = vec4(position, 1.0);
  vec3 place = vec3(dot(camera_from_node_x, p), dot(camera_from_node_y, p), dot(camera_from_node_z, p));
  gl_Position = clip_from_camera * vec4(place, 1.0);
  surface_color = color.w > 0.0 ? vec4(color.rgb, color.w < 2.0 ? base.a : color.w - 2.0) : base;
#ifdef STYLE
  apply_style(place, texture_coordinate.x * specular.w);
#endif
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
  texture_place.y = 1.0 - texture_place.y;  // image rows start at the top, but t = 0 is the bottom
#endif
}
)glsl";

/// Fragment shader of meshes, with the colours of VRML97 Tables 4.5 and 4.6. Defines: those of the vertex shader.
/// Further defines with TEXTURE:
/// - CUT_OUT: discards transparent pixels, which prevents an early depth test;
/// - SMOOTH_EDGES: converts alpha to sample coverage;
/// - PER_SAMPLE: with SMOOTH_EDGES, the shader runs for each sample instead; SAMPLED is then `sample`, else empty;
/// - MASK: the texture only cuts out faces of one colour.
inline constexpr char kMeshFragmentShader[] = R"glsl(
#if defined(FOG) || (defined(LIT) && (defined(LOCAL_LIGHTS) || defined(SPECULAR) || !defined(NORMALS)))
#define POSITION
#endif
#ifdef MASK
flat
#endif
in vec4 surface_color;
#ifdef TEXTURE
SAMPLED in vec2 texture_place;
uniform sampler2D image;
uniform ivec2 replaces;  // 1 if the texture replaces: x the colour, y alpha; y is 2 if it modulates alpha
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
  vec3 n = cross(dFdx(camera_position), dFdy(camera_position));  // points towards the viewer
  return n * inversesqrt(max(dot(n, n), 1e-37));
#endif
}

#endif

void main() {
  vec4 color = surface_color;
#ifdef TEXTURE
#ifdef STYLE
  vec4 texel = texture(image, place_in_image(texture_place));
#else
  vec4 texel = texture(image, texture_place);
#endif
#ifndef MASK
  color.rgb = replaces.x != 0 ? texel.rgb : color.rgb * texel.rgb;
  if (replaces.y != 0) color.a = replaces.y == 2 ? color.a * texel.a : texel.a;
#endif
#ifdef CUT_OUT
#if defined(SMOOTH_EDGES) && !defined(PER_SAMPLE)
  // Alpha becomes the share of four places of the pixel that are inside, as with pixels as samples. OpenGL converts it to
  // a number of samples. Quarters are exact for any rounding of the driver.
  vec2 right = dFdx(texture_place) * 0.25, up = dFdy(texture_place) * 0.25;
  vec4 around = vec4(texture(image, texture_place + right + up).a, texture(image, texture_place + right - up).a,
                     texture(image, texture_place - right + up).a, texture(image, texture_place - right - up).a);
  color.a *= dot(step(0.5, around), vec4(0.25));
#else
  if (texel.a < 0.5) discard;
#endif
#endif
#endif
#ifdef LIT
  color.rgb = lit(surface_normal(), camera_position, color.rgb, emissive_ambient, specular_exponent);
#endif
#ifdef STYLE
  color = styled(color, camera_position);
#elif defined(FOG)
  color.rgb = fogged(color.rgb, camera_position);
#endif
  result = color;
}
)glsl";

/// Vertex shader of one triangle that covers the viewport.
inline constexpr char kScreenVertexShader[] = R"glsl(
void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
  gl_Position = vec4(corner, 0.0, 1.0);
}
)glsl";

/// Vertex shader of one triangle that covers the viewport; computes it from gl_VertexID alone.
inline constexpr char kBackgroundVertexShader[] = R"glsl(
uniform mat3 background_from_camera;
uniform vec2 tangents, center;  // tangents of half the angles of view, and of the image centre
out vec3 ray;
void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
  ray = background_from_camera * vec3(corner * tangents + center, -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)glsl";

/// Fragment shader of the sky and ground spheres (VRML97 6.5). `rings` holds colours and angles: rings of the sky, then
/// of the ground.
inline constexpr char kBackgroundFragmentShader[] = R"glsl(
uniform sampler2D rings;
uniform ivec2 counts;  // number of rings: sky, ground
in vec3 ray;
out vec4 result;

vec3 ring_color(int first, int count, float angle) {
  int low = 0, high = count - 1;  // searches the last ring with an angle of at most `angle`
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
    // This pass shades once per pixel, so multisampling cannot smooth the edge of the ground.
    float last = texelFetch(rings, ivec2(counts.x + counts.y - 1, 0), 0).w;
    color = mix(color, ring_color(counts.x, counts.y, from_nadir), clamp((last - from_nadir) / pixel + 0.5, 0.0, 1.0));
  }
  result = vec4(color, 1.0);
}
)glsl";

/// Vertex shader of a face of the panorama's cube (VRML97 6.5): four corners of a triangle strip, infinitely far away.
inline constexpr char kPanoramaVertexShader[] = R"glsl(
uniform mat3 camera_from_face;  // columns: right, up and forward axis of the face
uniform vec2 tangents, center;  // tangents of half the angles of view, and of the image centre
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec3 ray = camera_from_face * vec3(corner * 2.0 - 1.0, 1.0);
  place = vec2(corner.x, 1.0 - corner.y);  // image rows start at the top
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
