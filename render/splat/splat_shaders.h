#pragma once

// GLSL 3.30 of the GPU splatter of surfaces, without the #version line. make_program adds that line and the #defines.
// Does the same as splat_raster.cpp and splat_tile_loop.inc; the constants are in splat_constants.h.
namespace gs::render {

/// Decodes a vector from the buffers of SplatStore. An instance draws up to 64 (SplatGl::kAnInstance) vectors of one
/// piece, four vertices each. Define: CELLS (splats of an octree).
inline constexpr char kSplatVectorShader[] = R"glsl(
struct Vector {
  vec3 position, normal;
  float radius, edge, offset;  // edge 0 means no cube
  vec3 color;
  bool drawn;
};
/// Values that all vectors of a piece share; three texels of `pieces`.
struct Piece {
  vec3 lower;  // position = lower + code * step, in node space
  vec3 step;
  vec2 radius;  // logarithm of the smallest radius, and what a step of the code adds to it
  vec2 edge;  // log2 of the minimum edge, and its increase per code
  float scale;  // factor of radii
  float tint;  // 24-bit colour that replaces all colours; negative: none
};
layout(location = 0) in uvec2 instance;  // x: first vector; y: number of vectors (low byte), index of piece
uniform usamplerBuffer vectors;
uniform sampler2D pieces;
uniform int stride;  // draws one of `stride` vectors
uniform bool color_by_normal;

// Sets the index of this vertex's vector. Returns false if the instance has no such vector.
bool find_vector(out int index) {
  int i = gl_VertexID >> 2;
  index = int(instance.x) + i * stride;
  return i < int(instance.y & 255u);
}

Piece read_piece() {
  int number = int(instance.y >> 8);
  ivec2 at = ivec2((number % PIECES_A_ROW) * 3, number / PIECES_A_ROW);
  vec4 a = texelFetch(pieces, at, 0), b = texelFetch(pieces, at + ivec2(1, 0), 0),
       c = texelFetch(pieces, at + ivec2(2, 0), 0);
  return Piece(a.xyz, b.xyz, vec2(a.w, b.w), c.xy, c.z, c.w);
}

vec3 rgb8(uint code) {
  return vec3(uvec3(code, code >> 8, code >> 16) & 255u) * (1.0 / 255.0);
}

#ifdef CELLS
uniform usamplerBuffer cells;
#endif

// Decodes a vector that encode_splats (splat_store.h) wrote.
Vector read_vector(int index) {
  Vector v;
  Piece piece = read_piece();
  uvec4 disc = texelFetch(vectors, index);
  v.position = piece.lower + vec3(disc.xyz & 0xfffffu) * piece.step;
  uint more = disc.w >> 24;
  uvec2 direction = disc.xy >> 20 | (uvec2(more, more >> 2) & 3u) << 12;
  vec2 octahedron = (vec2(direction) - 8191.0) * (1.0 / 8191.0);
  v.normal = vec3(octahedron, 1.0 - abs(octahedron.x) - abs(octahedron.y));
  if (v.normal.z < 0.0)
    v.normal.xy = (1.0 - abs(octahedron.yx)) * vec2(octahedron.x < 0.0 ? -1.0 : 1.0, octahedron.y < 0.0 ? -1.0 : 1.0);
  v.normal = normalize(v.normal);
  uint radius = disc.z >> 20 | (more >> 4) << 12;
  v.drawn = radius != 0u;
  v.radius = exp2(piece.radius.x + float(radius) * piece.radius.y) * piece.scale;
  v.color = rgb8(piece.tint < 0.0 ? disc.w : uint(piece.tint));
  if (color_by_normal) v.color = v.normal * 0.5 + 0.5;
  v.edge = v.offset = 0.0;
#ifdef CELLS
  uint cell = texelFetch(cells, index).r, edge = cell & 0xffffu;
  if (edge != 0u) v.edge = exp2(piece.edge.x + float(edge) * piece.edge.y);
  v.offset = (float(cell >> 16) - 32767.0) * (OFFSET_RANGE / 32767.0) * v.edge;
#endif
  return v;
}
)glsl";

/// Computes a rectangle around the samples that a splat may touch: those that it covers or, with BLEND, those in its
/// bell. Works in node space, relative to the camera. Defines: those of kSplatVectorShader, SIDES (two-sided), BLEND.
inline constexpr char kSplatDiscVertexShader[] = R"glsl(
uniform vec3 row_x, row_y, row_z;  // rows of the linear part of camera_from_node
uniform vec2 tangents, middle, margin;  // middle: tangents of the image centre; margin: of the rectangle, in clip space
uniform vec4 clip_planes[8];  // in node space, relative to the eye
uniform int clip_count;
uniform float near_plane, sample_size;  // sample_size: width of a sample at depth 1, in node units
flat out vec4 normal_plane;
#ifdef BLEND
flat out vec4 place_quarter;
flat out vec3 color;
#else
flat out vec4 clip_reach;
#endif

void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside of clip space: draws nothing
  normal_plane = vec4(0.0);
#ifdef BLEND
  place_quarter = vec4(0.0);
  color = vec3(0.0);
#else
  clip_reach = vec4(0.0);
#endif
  int index;
  if (!find_vector(index)) return;
  Vector v = read_vector(index);
  if (!v.drawn) return;
  vec3 place = v.position;
  for (int i = 0; i < clip_count; ++i)
    if (dot(clip_planes[i], vec4(place, 1.0)) < 0.0) return;
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
  vec3 extent, center;  // centre and half size of a box in camera space
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
  low = (min(low / nearest, low / farthest) - middle) / tangents - margin;
  high = (max(high / nearest, high / farthest) - middle) / tangents + margin;
  if (!(low.x < 1.0 && low.y < 1.0 && high.x > -1.0 && high.y > -1.0)) return;
  bvec2 upper = bvec2((gl_VertexID & 1) != 0, (gl_VertexID & 2) != 0);
  vec2 corner = vec2(upper.x ? high.x : low.x, upper.y ? high.y : low.y);
  gl_Position = vec4(clamp(corner, -1.0, 1.0), 0.0, 1.0);
}
)glsl";

/// Writes the depth of the nearest surface at each sample; negative for a back face. Needs the depth test GREATER.
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

/// Sums the contributions of the splats near the nearest surface, with their bells as weights.
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
  // (1 - rho^2 / 4)^4: nearly exp(-1.2 rho^2), and 0 beyond two radii.
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

/// Averages the samples of each pixel. The result is a SplatLayer in textures, the input of the shading pass. Defines:
/// COLORS, SMOOTH.
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

/// Shades the pixels of the splatter. Follows kLightingShader and, with FOG, kFogShader. Defines: COLORS, FOG, those of
/// the lights, CLOSING (does the same as close_pinholes() in splat_closing.h).
inline constexpr char kSplatFragmentShader[] = R"glsl(
uniform sampler2D normals, depths;
#ifdef COLORS
uniform sampler2D colors;
#endif
uniform ivec2 origin, size;  // lower left corner and size of the viewport
uniform vec4 rectangle;  // rectangle in the viewport that the textures contain: first pixel, and end (exclusive)
uniform ivec2 corner;  // pixel of the viewport at the first texel
#ifdef CLOSING
uniform int closing;  // maximum width of holes, in pixels
#endif
uniform vec2 pixel, tangents, middle;  // 2 / viewport size; tangents: of half the view, of its centre
uniform vec2 depth_row;  // Projection::depth_offset and depth_scale
uniform vec4 base, emissive_ambient, specular_exponent;
out vec4 result;

vec3 normal = vec3(0.0), color = vec3(0.0);
float depth = 0.0, count = 0.0;

void add(ivec2 at, vec3 n) {
  normal += n * 2.0 - 1.0;
  depth += texelFetch(depths, at - corner, 0).r;
#ifdef COLORS
  color += texelFetch(colors, at - corner, 0).rgb;
#endif
  count += 1.0;
}

bool outside(ivec2 at) {
  return any(lessThan(vec2(at), rectangle.xy)) || any(greaterThanEqual(vec2(at), rectangle.zw));
}

#ifdef CLOSING
// Returns the maximum coverage on one side, up to `closing` pixels away. If `fill`, adds the nearest covered pixel.
float beside(ivec2 at, ivec2 way, bool fill) {
  float most = 0.0;
  for (int i = 1; i <= closing; ++i) {
    ivec2 there = at + way * i;
    if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, size))) return 1.0;
    if (outside(there)) break;
    vec4 found = texelFetch(normals, there - corner, 0);
    if (fill && most == 0.0 && found.a > 0.0) add(there, found.xyz);
    most = max(most, found.a);
    if (most == 1.0) break;
  }
  return most;
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - origin;
  // With multisampling, Mesa's llvmpipe draws one row outside of the scissor rectangle.
  if (outside(at)) discard;
  vec4 own = texelFetch(normals, at - corner, 0);
  float coverage = own.a;
  if (coverage > 0.0) add(at, own.xyz);
#ifdef CLOSING
  if (coverage < 1.0) {
    bool fill = coverage == 0.0;
    float least = beside(at, ivec2(1, 0), fill);
    if (least > coverage) least = min(least, beside(at, ivec2(-1, 0), fill));
    if (least > coverage) least = min(least, beside(at, ivec2(0, 1), fill));
    if (least > coverage) least = min(least, beside(at, ivec2(0, -1), fill));
    coverage = max(coverage, least);
  }
#endif
  if (coverage == 0.0 || count == 0.0) discard;
  depth /= count;
  vec3 place = vec3(((vec2(at) + 0.5) * pixel - 1.0) * tangents + middle, -1.0) * depth;
#ifdef COLORS
  color /= count;
#else
  color = base.rgb;
#endif
  float length2 = dot(normal, normal);
  vec3 n = length2 > 0.0 ? normal * inversesqrt(length2) : vec3(0.0, 0.0, 1.0);
  color = lit(n, place, color, emissive_ambient, specular_exponent);
#ifdef FOG
  color = fogged(color, place);
#endif
  result = vec4(color, coverage * base.a);
  gl_FragDepth = clamp(depth_row.x + depth_row.y / depth, 0.0, 1.0);
}
)glsl";

}  // namespace gs::render
