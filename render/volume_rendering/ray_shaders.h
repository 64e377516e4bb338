#pragma once

// GLSL of the ray caster for volumes of X3D. volume_source.cpp makes the code of the styles.
namespace gs::render {

/// Vertex shader of the box of a volume: 36 vertices, outside counterclockwise. Only its back faces are drawn, because
/// the viewer may be inside.
inline constexpr char kVolumeBoxVertexShader[] = R"glsl(
uniform mat4 clip_from_viewer, viewer_from_box;
uniform float camera_back;
out vec3 exit_place, exit_viewer;  // in box coordinates, 0 to 1, and in camera space
out float exit_depth;              // distance from the camera along the view axis
void main() {
  int face = gl_VertexID / 6, corner = gl_VertexID % 6, axis = face >> 1;
  bool side = (face & 1) == 1;
  float u = corner == 1 || corner == 2 || corner == 4 ? 1.0 : 0.0, v = corner == 2 || corner > 3 ? 1.0 : 0.0;
  vec3 place = vec3(0.0);
  place[axis] = side ? 1.0 : 0.0;
  place[(axis + 1) % 3] = side ? u : v;
  place[(axis + 2) % 3] = side ? v : u;
  exit_place = place;
  exit_viewer = (viewer_from_box * vec4(place, 1.0)).xyz;
  exit_depth = camera_back - exit_viewer.z;
  gl_Position = clip_from_viewer * vec4(exit_viewer, 1.0);
}
)glsl";

/// Inputs and functions for the code of the styles. Defines:
/// - COMPONENTS of the voxels; GRADIENTS: texture with gradients, GIVEN_GRADIENTS: of normals that the world gives;
/// - SEGMENTS; SURFACES: number of isosurfaces; LIT: kLightingShader precedes;
/// - PROJECTION with MAXIMUM, MINIMUM or AVERAGE, and THRESHOLD; PROJECTION_COLORS: texture with colours of its values;
/// - SHADOWS: a function opacity_at() follows;
/// - FOG: kFogShader precedes; BLOCKS: texture with the occupied blocks.
inline constexpr char kVolumeRayInputs[] = R"glsl(
in vec3 exit_place, exit_viewer;
in float exit_depth;
out vec4 result;
uniform sampler3D voxels;
#ifdef GRADIENTS
uniform sampler3D gradients;
#endif
#ifdef SEGMENTS
uniform sampler3D segments;
uniform int hidden_segments[8];  // bits
#endif
#ifdef SURFACES
uniform float surfaces[SURFACES];
uniform int surface_chains[SURFACES];
uniform float least_gradient;
#endif
#ifdef PROJECTION_COLORS
uniform sampler2D projection_colors;
#endif
#ifdef BLOCKS
uniform sampler3D blocks;  // 0 if a block of voxels is invisible
uniform vec3 block_count;  // voxels divided by the side of a block
#endif
uniform sampler2D depths;       // of the opaque objects
uniform vec2 depth_of;          // window depth at distance d is x + y / d
uniform vec3 eye;               // camera in box coordinates
uniform float camera_back;      // distance of the camera behind the viewer
uniform float near_depth, rate;  // `rate`: samples per voxel
uniform mat4 viewer_from_box;
uniform mat3 normal_from_gradient, normal_from_local;  // to camera space
uniform vec3 voxel_count, dimensions;
uniform float voxel_length;  // in the space of the node
uniform float threshold;     // of the projection
uniform vec4 clip_planes[8]; // in box coordinates
uniform int clip_plane_count;

vec4 components_of(vec4 texel, int components) {
  return vec4(texel.r, components > 1 ? texel.g : 0.0, components > 2 ? texel.b : 0.0, components > 3 ? texel.a : 0.0);
}
// Default colour and opacity of a voxel: grey by its intensity (X3D 41.4.7), or its own colour and alpha.
vec4 color_of(vec4 raw, int components) {
  if (components == 1) return raw.rrrr;
  if (components == 2) return raw.rrrg;
  return components == 3 ? vec4(raw.rgb, dot(raw.rgb, vec3(1.0 / 3.0))) : raw;
}
vec4 voxel_at(vec3 p) { return components_of(texture(voxels, p), COMPONENTS); }
float intensity_of(vec4 raw) { return COMPONENTS < 3 ? raw.r : dot(raw.rgb, vec3(1.0 / 3.0)); }
float alpha_of(vec4 raw) { return COMPONENTS == 2 ? raw.g : COMPONENTS == 4 ? raw.a : 1.0; }

vec4 with_length(vec3 normal, float gradient) {
  float square = dot(normal, normal);
  return square > 1e-12 && gradient > 0.0 ? vec4(normal * inversesqrt(square), gradient) : vec4(0.0);
}
// Returns the normal that a texture of the world gives, and its length.
vec4 given_normal(sampler3D normals, vec3 p) {
  vec3 given = texture(normals, p).xyz * 2.0 - 1.0;
  return with_length(normal_from_local * given, length(given));
}
// Returns the normal of a texture of gradients: it points to smaller values.
vec4 normal_at(sampler3D gradients, vec3 p) {
#ifdef GIVEN_GRADIENTS
  return given_normal(gradients, p);
#else
  vec4 texel = texture(gradients, p);
  return with_length(normal_from_gradient * (texel.xyz * 2.0 - 1.0), texel.w * 0.866025404);
#endif
}

#ifdef LIT
const int kMostLights = 8;
vec3 direction_to(Light light, vec3 place) {
  vec3 l = light.location_local.xyz - light.location_local.w * place;
  return l * inversesqrt(max(dot(l, l), 1e-30));
}
#ifdef SHADOWS
uniform mat3 box_from_viewer;  // of directions
// Returns the opacity of a voxel for the shadows of the style with this number.
float opacity_at(int number, vec3 p);
// Returns the part of a light that reaches a place: the voxels between them weaken it.
float reaching(Light light, int number, vec3 p, vec3 place) {
  const float kMostSamples = 48.0;
  vec3 dir = box_from_viewer * direction_to(light, place);
  vec3 borders = (step(vec3(0.0), dir) - p) / dir;
  float far = min(min(abs(dir.x) > 1e-9 ? borders.x : 1e9, abs(dir.y) > 1e-9 ? borders.y : 1e9),
                  abs(dir.z) > 1e-9 ? borders.z : 1e9);
  if (light.location_local.w > 0.0) far = min(far, length(light.location_local.xyz - place));
  vec3 voxels_of_dir = abs(dir) * voxel_count;
  float along = max(max(max(voxels_of_dir.x, voxels_of_dir.y), voxels_of_dir.z), 1e-9);
  float near = 1.5 / along;  // a surface does not shade itself
  if (far <= near) return 1.0;
  float count = clamp(ceil((far - near) * along), 1.0, kMostSamples);
  float size = (far - near) / count, thickness = size * length(dir * dimensions) / voxel_length;
  float left = 1.0;
  for (float i = 0.5; i < count && left > 0.01; i += 1.0) {
    float a = clamp(opacity_at(number, p + dir * (near + i * size)), 0.0, 1.0);
    left *= pow(1.0 - a, thickness);
  }
  return left;
}
#endif
// X3D 41.4.12.
vec3 toned(vec3 n, vec3 place, vec3 warm, vec3 cool) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < min(light_count, kMostLights); ++i)
    sum += mix(cool, warm, 0.5 + 0.5 * dot(n, direction_to(light_at(i), place)));
  return min(sum, 1.0);
}
// X3D 41.4.10. Voxels in places of equal values have no normal: they scatter light by the phase function of Henyey and
// Greenstein, normalised to the mean 1.
// `shadow` is the number of a style with shadows; -1 means none.
vec3 shaded(vec4 n, vec3 place, vec3 to_viewer, vec3 diffuse, vec4 emissive_ambient, vec4 specular, float scatters,
            int shadow, vec3 p) {
#ifdef SURFACES
  if (dot(n.xyz, to_viewer) < 0.0) n.xyz = -n.xyz;  // both sides of a surface are lit
  float surface = 1.0;
#else
  float surface = clamp(n.w * 48.0, 0.0, 1.0);
#endif
  const float g = 0.2;
  vec3 ambient = diffuse * emissive_ambient.w, sum = vec3(0.0);
  const vec4 dull = vec4(0.0, 0.0, 0.0, 1.0);
  for (int i = 0; i < min(light_count, kMostLights); ++i) {
    Light light = light_at(i);
    vec3 lit = reflected(light, n.xyz, place, to_viewer, diffuse, ambient, specular);
    if (scatters > 0.0 && surface < 1.0) {
      vec3 l = direction_to(light, place);
      float phase = (1.0 - g * g) * pow(1.0 + g * g - 2.0 * g * dot(-l, to_viewer), -1.5);
      lit = mix(reflected(light, l, place, to_viewer, diffuse * phase, ambient, dull), lit, surface);
    }
#ifdef SHADOWS
    if (shadow >= 0)
      lit = mix(reflected(light, n.xyz, place, to_viewer, vec3(0.0), ambient, dull), lit,
                reaching(light, shadow, p, place));
#endif
    sum += lit;
  }
  return clamp(sum + emissive_ambient.rgb, 0.0, 1.0);
}
#endif
)glsl";

/// Main function of the ray caster. Composites from front to back up to the opaque objects; the result is
/// premultiplied by its alpha.
inline constexpr char kVolumeRayMain[] = R"glsl(
#ifdef SEGMENTS
// Returns the segment of a place; -1 if it is hidden.
int segment_at(vec3 p) {
  ivec3 size = textureSize(segments, 0);
  int id = int(texelFetch(segments, clamp(ivec3(p * vec3(size)), ivec3(0), size - 1), 0).r * 255.0 + 0.5);
  return (uint(hidden_segments[id >> 5]) >> uint(id & 31) & 1u) != 0u ? -1 : id;
}
#endif

void main() {
  vec3 away = exit_place - eye;
  float whole = length(away);
  vec3 dir = away / whole;
  // Places on the ray are exit_place - dir * u.
  vec3 borders = (exit_place - step(dir, vec3(0.0))) / dir;
  float high = min(min(abs(dir.x) > 1e-9 ? borders.x : 1e9, abs(dir.y) > 1e-9 ? borders.y : 1e9),
                   abs(dir.z) > 1e-9 ? borders.z : 1e9);
  high = min(high, whole * (1.0 - near_depth / exit_depth));
  float stop = depth_of.y / (texelFetch(depths, ivec2(gl_FragCoord.xy), 0).r - depth_of.x);
  float low = stop < exit_depth && stop > 0.0 ? whole * (1.0 - stop / exit_depth) : 0.0;
  for (int i = 0; i < clip_plane_count; ++i) {
    float at = dot(clip_planes[i], vec4(exit_place, 1.0)), slope = -dot(clip_planes[i].xyz, dir);
    if (slope > 1e-12) low = max(low, -at / slope);
    else if (slope < -1e-12) high = min(high, -at / slope);
    else if (at < 0.0) discard;
  }
  float span = high - low;
  if (!(span > 0.0)) discard;
  vec3 voxels_of_dir = abs(dir) * voxel_count;
  float along = max(max(voxels_of_dir.x, voxels_of_dir.y), voxels_of_dir.z);
  int count = int(clamp(ceil(span * along * rate), 1.0, 8192.0));
  float size = span / float(count);
  float thickness = size * length(dir * dimensions) / voxel_length;
  vec3 to_viewer = vec3(0.0, 0.0, camera_back) - exit_viewer;
  to_viewer *= inversesqrt(max(dot(to_viewer, to_viewer), 1e-30));
  vec3 viewer_step = mat3(viewer_from_box) * -dir;
  vec4 sum = vec4(0.0);
  float middle = 0.0;
#ifdef PROJECTION
  float best = -1.0, best_alpha = 0.0, numbers = 0.0;
  bool found = false, settled = false;
#endif
#ifdef SURFACES
  float before = intensity_of(voxel_at(exit_place - dir * high)), before_u = high;
#endif
#ifdef BLOCKS
  int tested = 0;  // samples before it lie in an occupied block
#endif
  for (int i = 0; i < count; ++i) {
    float u = high - (float(i) + 0.5) * size;
#ifdef SURFACES
    if (i == count - 1) u = low;
#endif
    vec3 p = exit_place - dir * u;
#ifdef BLOCKS
    if (i >= tested) {
      vec3 block = p * block_count;
      ivec3 cell = clamp(ivec3(block), ivec3(0), textureSize(blocks, 0) - 1);
      vec3 ahead = (vec3(cell) + step(vec3(0.0), dir) - block) / (dir * block_count);
      float next = min(min(abs(dir.x) > 1e-9 ? ahead.x : 1e9, abs(dir.y) > 1e-9 ? ahead.y : 1e9),
                       abs(dir.z) > 1e-9 ? ahead.z : 1e9);
      int samples = int(clamp(floor(next / size), 0.0, 8192.0));
      if (texelFetch(blocks, cell, 0).r == 0.0) {
        i += samples;
#ifdef SURFACES
        before_u = max(high - (float(i) + 0.5) * size, low);
        before = intensity_of(voxel_at(exit_place - dir * before_u));
#endif
        continue;
      }
      tested = i + samples + 1;
    }
#endif
    vec4 raw = voxel_at(p);
#ifdef SEGMENTS
    int which = segment_at(p);
    if (which < 0) continue;
#else
    const int which = 0;
#endif
    bool projected;
#ifdef SURFACES
    float value = intensity_of(raw);
    for (int k = 0; k < SURFACES; ++k) {
      int surface = value > before ? k : SURFACES - 1 - k;
      float wanted = surfaces[surface];
      if ((before < wanted) == (value < wanted)) continue;
      // Regula falsi between the two samples.
      float u0 = before_u, v0 = before, u1 = u, v1 = value, hit = u;
      for (int step_number = 0; step_number < 3; ++step_number) {
        hit = mix(u0, u1, clamp((wanted - v0) / (v1 - v0), 0.0, 1.0));
        float v = intensity_of(voxel_at(exit_place - dir * hit));
        if ((v < wanted) == (v0 < wanted)) u0 = hit, v0 = v; else u1 = hit, v1 = v;
        if (v0 == v1) break;
      }
      vec3 q = exit_place - dir * hit, place = exit_viewer + viewer_step * hit;
      if (normal_at(gradients, q).w <= least_gradient) continue;
      vec4 there = voxel_at(q);
      vec4 c = chain(surface_chains[surface], vec4(color_of(there, COMPONENTS).rgb, 1.0), there, q, place, to_viewer,
                     projected);
      float weight = (1.0 - sum.a) * clamp(c.a, 0.0, 1.0);
      sum += weight * vec4(c.rgb, 1.0);
      middle += weight * hit;
    }
    before = value;
    before_u = u;
#else
    vec3 place = exit_viewer + viewer_step * u;
    vec4 c = chain(which, color_of(raw, COMPONENTS), raw, p, place, to_viewer, projected);
#ifdef PROJECTION
    if (projected) {
      float value = intensity_of(raw), alpha = alpha_of(raw);
      found = true;
#ifdef AVERAGE
      best = numbers == 0.0 ? value : best + value;
      best_alpha += alpha;
      numbers += 1.0;
#else
#ifdef MAXIMUM
      bool better = value > best;
#ifdef THRESHOLD
      if (!better && best > threshold) settled = true;  // the first local maximum above the threshold
#endif
#else
      bool better = best < 0.0 || value < best;
#ifdef THRESHOLD
      if (!better && best >= 0.0 && best < threshold) settled = true;
#endif
#endif
      if (better && !settled) best = value, best_alpha = alpha;
#if defined(THRESHOLD) && !defined(SEGMENTS)
      if (settled) break;
#endif
#endif
      continue;
    }
#endif
    float weight = (1.0 - sum.a) * (1.0 - pow(1.0 - clamp(c.a, 0.0, 1.0), thickness));
    sum += weight * vec4(c.rgb, 1.0);
    middle += weight * u;
#endif
    if (sum.a > 0.995) break;
  }
#ifdef PROJECTION
  if (found) {
#ifdef AVERAGE
    best /= numbers;
    best_alpha /= numbers;
#endif
#ifdef PROJECTION_COLORS
    vec4 shown = texture(projection_colors, vec2(best, 0.5));
#else
    vec4 shown = vec4(vec3(best), best_alpha);
#endif
    float weight = (1.0 - sum.a) * shown.a;
    sum += weight * vec4(shown.rgb, 1.0);
    middle += weight * 0.5 * (low + high);
  }
#endif
  if (sum.a <= 0.0) discard;
#ifdef FOG
  sum.rgb = fogged(sum.rgb / sum.a, exit_viewer + viewer_step * (middle / sum.a)) * sum.a;
#endif
  result = sum;
}
)glsl";

}  // namespace gs::render
