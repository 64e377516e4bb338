#pragma once

// GLSL 3.30 of the surface splatter on the GPU, without the #version line, which make_program writes together with the
// #defines. It mirrors splat_raster.cpp and splat_tile_loop.h; the constants come from splat_constants.h.
namespace gs::render {

/// What a vector is, as the instance buffer holds it. Defines: RECORDS (8-byte records of a stream, qnv/record.h),
/// CELLS (discs of an octree).
inline constexpr char kSplatVectorShader[] = R"glsl(
struct Vector {
  vec3 position, normal;
  float radius, edge, offset;  // edge 0: no cube
  vec3 color;
  bool drawn;
};
uniform vec3 frame_lower, frame_step;
#ifdef RECORDS
layout(location = 0) in uvec2 record;
uniform float weight_step;
uniform sampler2D normal_table;  // theta, phi
uniform sampler2D palette;

// In bits, from the lowest: X 10, Y 10, Z 10, theta 5, phi 6, A 15, C 8. frame_step is half a cell, so that every
// product is exact and the position is that of qnv::unpack_record to the last bit.
void unpack_record(out vec3 position, out vec3 normal, out float weight, out int color) {
  uint low = record.x, high = record.y;
  uvec3 code = uvec3(low, low >> 10, low >> 20) & 1023u;
  position = frame_lower + vec3(2u * code + 1u) * frame_step;
  normal = texelFetch(normal_table, ivec2(int(low >> 30 | (high & 7u) << 2), int(high >> 3 & 63u)), 0).xyz;
  weight = float(max(high >> 9 & 32767u, 1u)) * weight_step;
  color = int(high >> 24);
}

Vector read_vector() {
  Vector v;
  float weight;
  int color;
  unpack_record(v.position, v.normal, weight, color);
  v.radius = sqrt(weight * (1.0 / PI));
  v.edge = v.offset = 0.0;
  v.color = texelFetch(palette, ivec2(color, 0), 0).rgb;
  v.drawn = true;
  return v;
}
#else
layout(location = 0) in uvec4 disc;
uniform vec2 radius_code;  // logarithm of the smallest radius, and what a step of the code adds to it
uniform float radius_scale;
#ifdef CELLS
layout(location = 1) in uint cell;
uniform vec2 edge_code;
#endif

// As encode_splats (splat_store.h) writes them.
Vector read_vector() {
  Vector v;
  v.position = frame_lower + vec3(disc.xyz & 0xfffffu) * frame_step;
  uint more = disc.w >> 24;
  uvec2 direction = disc.xy >> 20 | (uvec2(more, more >> 2) & 3u) << 12;
  vec2 octahedron = (vec2(direction) - 8191.0) * (1.0 / 8191.0);
  v.normal = vec3(octahedron, 1.0 - abs(octahedron.x) - abs(octahedron.y));
  if (v.normal.z < 0.0)
    v.normal.xy = (1.0 - abs(octahedron.yx)) * vec2(octahedron.x < 0.0 ? -1.0 : 1.0, octahedron.y < 0.0 ? -1.0 : 1.0);
  v.normal = normalize(v.normal);
  uint radius = disc.z >> 20 | (more >> 4) << 12;
  v.drawn = radius != 0u;
  v.radius = exp2(radius_code.x + float(radius) * radius_code.y) * radius_scale;
  v.color = vec3(uvec3(disc.w, disc.w >> 8, disc.w >> 16) & 255u) * (1.0 / 255.0);
  v.edge = v.offset = 0.0;
#ifdef CELLS
  uint edge = cell & 0xffffu;
  if (edge != 0u) v.edge = exp2(edge_code.x + float(edge) * edge_code.y);
  v.offset = (float(cell >> 16) - 32767.0) * (OFFSET_RANGE / 32767.0) * v.edge;
#endif
  return v;
}
#endif
)glsl";

/// A rectangle around the samples that a disc may touch: what covers the surface, or with BLEND what its bell reaches.
/// Node space, from the camera's place. Defines: those of the vectors, SIDES (seen from behind too), BLEND.
inline constexpr char kSplatDiscVertexShader[] = R"glsl(
uniform vec3 eye;
uniform vec3 row_x, row_y, row_z;  // of the linear part of camera_from_node
uniform vec2 tangents, margin;     // margin: of the rectangle, clip space
uniform float near_plane, sample_size;  // sample_size: of a sample at depth 1, node units
flat out vec4 normal_plane;
#ifdef BLEND
flat out vec4 place_quarter;
flat out vec3 color;
#else
flat out vec4 clip_reach;
#endif

void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // nothing
  normal_plane = vec4(0.0);
#ifdef BLEND
  place_quarter = vec4(0.0);
  color = vec3(0.0);
#else
  clip_reach = vec4(0.0);
#endif
  Vector v = read_vector();
  if (!v.drawn) return;
  vec3 place = v.position - eye;
  float plane = dot(v.normal, place);
#ifndef SIDES
  if (plane > 0.0) return;
#endif
  if (!(plane * plane > GRAZING * GRAZING * dot(place, place))) return;
  float least = -dot(row_z, place) * sample_size * LEAST_REACH;
  float bell = max(v.radius * DISC_BELL, least), reach = max(v.radius * DISC_COVER, least);
  vec3 clip = place;
  if (v.edge > 0.0) {
    clip -= v.normal * v.offset;
    float margin = plane > 0.0 ? v.edge * BACK_MARGIN
                               : max(v.edge * CUBE_MARGIN, least * (SAMPLE_MARGIN / LEAST_REACH));
    reach = max(v.edge * 0.5 + margin, least);
    bell = max(v.radius * CUBE_BELL, max(0.5 * v.edge, least));
  }
  normal_plane = vec4(v.normal, plane);
  vec3 extent, center;  // of a box in camera space
#ifdef BLEND
  place_quarter = vec4(place, 0.25 / (bell * bell));
  color = v.color;
  center = place;
  extent = 2.0 * bell * vec3(length(row_x), length(row_y), length(row_z));
#else
  clip_reach = vec4(clip, reach);
  center = clip;
#ifdef CELLS
  vec3 ones = vec3(1.0);
  extent = reach * vec3(dot(abs(row_x), ones), dot(abs(row_y), ones), dot(abs(row_z), ones));
#else
  vec3 across = vec3(dot(row_x, v.normal), dot(row_y, v.normal), dot(row_z, v.normal));
  vec3 squares = vec3(dot(row_x, row_x), dot(row_y, row_y), dot(row_z, row_z));
  extent = reach * sqrt(max(squares - across * across, 1e-6 * squares));
#endif
#endif
  vec2 seen = vec2(dot(row_x, center), dot(row_y, center));
  float depth = -dot(row_z, center), nearest = max(depth - extent.z, near_plane), farthest = depth + extent.z;
  if (!(farthest > near_plane)) return;
  vec2 low = seen - extent.xy, high = seen + extent.xy;
  low = min(low / nearest, low / farthest) / tangents - margin;
  high = max(high / nearest, high / farthest) / tangents + margin;
  if (!(low.x < 1.0 && low.y < 1.0 && high.x > -1.0 && high.y > -1.0)) return;
  bvec2 upper = bvec2((gl_VertexID & 1) != 0, (gl_VertexID & 2) != 0);
  vec2 corner = vec2(upper.x ? high.x : low.x, upper.y ? high.y : low.y);
  gl_Position = vec4(clamp(corner, -1.0, 1.0), 0.0, 1.0);
}
)glsl";

/// Leaves the depth of the nearest surface of every sample, negative where its back is seen. The depth test is GREATER.
inline constexpr char kSplatDepthFragmentShader[] = R"glsl(
uniform vec3 ray_origin, ray_right, ray_up;
uniform float near_plane;
flat in vec4 normal_plane, clip_reach;
layout(location = 0) out float nearest;
void main() {
  vec2 at = floor(gl_FragCoord.xy);
  vec3 ray = ray_origin + ray_right * at.x + ray_up * at.y;
  float depth = normal_plane.w / dot(normal_plane.xyz, ray);
  vec3 d = ray * depth - clip_reach.xyz;
#ifdef CELLS
  bool covered = max(max(abs(d.x), abs(d.y)), abs(d.z)) < clip_reach.w;
#else
  bool covered = dot(d, d) < clip_reach.w * clip_reach.w;
#endif
  if (!(covered && depth > near_plane)) discard;
  nearest = normal_plane.w > 0.0 ? -depth : depth;
  gl_FragDepth = near_plane / depth;
}
)glsl";

/// Adds up what the discs about the nearest surface give, weighted by their bells.
inline constexpr char kSplatBlendFragmentShader[] = R"glsl(
uniform vec3 ray_origin, ray_right, ray_up;
uniform sampler2D nearest;
flat in vec4 normal_plane, place_quarter;
flat in vec3 color;
layout(location = 0) out vec4 normal_weight;
layout(location = 1) out vec4 color_sum;
layout(location = 2) out vec4 slope_height;
layout(location = 3) out vec4 tilt_sum;
void main() {
  float depth = texelFetch(nearest, ivec2(gl_FragCoord.xy), 0).r;
#ifdef SIDES
  if (!(depth * normal_plane.w < 0.0)) discard;
  depth = abs(depth);
#else
  if (depth == 0.0) discard;
#endif
  vec2 at = floor(gl_FragCoord.xy);
  vec3 d = (ray_origin + ray_right * at.x + ray_up * at.y) * depth - place_quarter.xyz;
  // (1 - rho^2 / 4)^4: nearly exp(-1.2 rho^2), and nothing beyond two radii.
  float bell = 1.0 - dot(d, d) * place_quarter.w;
  if (!(bell > 0.0)) discard;
  float square = bell * bell;
  float slope = square * bell * (-8.0 * place_quarter.w);
  bell = square * square;
  normal_weight = vec4(normal_plane.xyz, 1.0) * bell;
  color_sum = vec4(color * bell, 0.0);
#ifdef SMOOTH
  float height = dot(d, normal_plane.xyz);
  slope_height = vec4(slope * d, bell * height);
  tilt_sum = vec4(slope * height * d, 0.0);
#else
  slope_height = tilt_sum = vec4(0.0);
#endif
}
)glsl";

/// Averages the samples of each pixel into what the shading pass reads, a SplatLayer in textures. Defines: COLORS,
/// SMOOTH.
inline constexpr char kSplatResolveFragmentShader[] = R"glsl(
uniform sampler2D nearest, sums;
#ifdef COLORS
uniform sampler2D color_sums;
#endif
#ifdef SMOOTH
uniform sampler2D slopes, tilts;
#endif
uniform mat3 normal_matrix;
uniform int supersample;
layout(location = 0) out vec4 normal_coverage;
layout(location = 1) out float depth;
layout(location = 2) out vec4 color;
void main() {
  vec3 normal = vec3(0.0), sum = vec3(0.0);
  float closest = 1e30, covered = 0.0;
  for (int y = 0; y < supersample; ++y)
    for (int x = 0; x < supersample; ++x) {
      ivec2 at = ivec2(gl_FragCoord.xy) * supersample + ivec2(x, y);
      vec4 normal_weight = texelFetch(sums, at, 0);
      if (!(normal_weight.w > 0.0)) continue;
      covered += 1.0;
      float signed_depth = texelFetch(nearest, at, 0).r;
      closest = min(closest, abs(signed_depth));
      vec3 n = normal_weight.xyz;
#ifdef SMOOTH
      vec4 slope_height = texelFetch(slopes, at, 0);
      n += SMOOTHING * (texelFetch(tilts, at, 0).xyz - slope_height.xyz * (slope_height.w / normal_weight.w));
#endif
      n = normal_matrix * n;
      float size = length(n);
      if (size > 0.0) normal += n * ((signed_depth < 0.0 ? -1.0 : 1.0) / size);
#ifdef COLORS
      sum += texelFetch(color_sums, at, 0).rgb / normal_weight.w;
#endif
    }
  float size = length(normal);
  normal = size > 0.0 ? normal / size : vec3(0.0, 0.0, 1.0);
  normal_coverage = covered > 0.0 ? vec4(normal * 0.5 + 0.5, covered / float(supersample * supersample)) : vec4(0.0);
  depth = covered > 0.0 ? closest : 0.0;
  color = vec4(sum / max(covered, 1.0), 1.0);
}
)glsl";

}  // namespace gs::render
