#pragma once

/// Shaders of volumes. make_program adds "#version 330 core" before each.
namespace gs::render {

/// Draws a rectangle over the viewport with a part of a texture from its first texel on.
inline constexpr char kPlainLayerVertexShader[] = R"glsl(
uniform vec2 part;  // drawn part of the texture
out vec2 at;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  at = corner * part;
  gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
)glsl";

inline constexpr char kPlainLayerFragmentShader[] = R"glsl(
uniform sampler2D pixels;
in vec2 at;
out vec4 result;
void main() { result = texture(pixels, at); }
)glsl";

/// Composites the volumes that the CPU has drawn. Where `depths` is negative, ignores the pixel's depth. With EDGES,
/// draws only pixels with samples that differ.
inline constexpr char kVolumePixelsFragmentShader[] = R"glsl(
uniform sampler2D pixels;
uniform sampler2D depths;  // in window space
uniform ivec2 origin;  // lower left corner of the viewport
uniform float nearest;  // window depth of the near plane
out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - origin;
  result = texelFetch(pixels, at, 0);
  float depth = texelFetch(depths, at, 0).r;
#ifdef EDGES
  if (depth < 0.0) discard;
#endif
  if (result.a == 0.0) discard;
  gl_FragDepth = depth < 0.0 ? nearest : depth;
}
)glsl";

/// Finds the depths of the samples of a pixel, in window space. Samples of one surface count as one depth, the nearest.
inline constexpr char kVolumeSamplesShader[] = R"glsl(
uniform sampler2DMS depths;
uniform int samples;
uniform vec2 depth_row;  // window depth at distance d is x + y / d
uniform vec2 depth_range;  // nearest and farthest window depth
uniform float smooth_part;  // samples of one surface differ in distance by at most this factor
// Returns the nearest and the farthest depth, which are equal for one surface.
vec2 near_far(ivec2 at) {
  float least = 1.0, most = 0.0;
  for (int i = 0; i < samples; ++i) {
    float depth = texelFetch(depths, at, i).r;
    least = min(least, depth);
    most = max(most, depth);
  }
  vec2 result = depth_range.x > depth_range.y ? vec2(most, least) : vec2(least, most);
  vec2 inverse = (result - depth_row.x) / depth_row.y;  // of the distances
  bool edge = result.x != result.y && (result.y == depth_range.y || inverse.y < smooth_part * inverse.x);
  return edge ? result : result.xx;
}
)glsl";

/// Writes the depths of the farthest samples; with EDGES, of the nearest samples of pixels with several surfaces.
inline constexpr char kVolumeDepthsFragmentShader[] = R"glsl(
out vec4 result;
void main() {
  vec2 depth = near_far(ivec2(gl_FragCoord.xy));
#ifdef EDGES
  if (depth.x == depth.y) discard;
  gl_FragDepth = depth.x;
#else
  gl_FragDepth = depth.y;
#endif
  result = vec4(0.0);
}
)glsl";

/// Writes the nearest depth to the opaque pixels of a layer. Their transmittance is below half a step of 8 bits.
inline constexpr char kVolumeClosingFragmentShader[] = R"glsl(
uniform sampler2D layer;
uniform float nearest;
void main() {
  if (texelFetch(layer, ivec2(gl_FragCoord.xy), 0).a < 511.0 / 512.0) discard;
  gl_FragDepth = nearest;
}
)glsl";

/// Composites the layer that OpenGL has blended. With SAMPLES, writes the depth that separates the samples of a pixel
/// with several surfaces. With EDGES, draws only such pixels.
inline constexpr char kVolumeLayerFragmentShader[] = R"glsl(
uniform ivec2 origin;
uniform sampler2D layer;
uniform float gain;
out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - origin;
#ifdef SAMPLES
  vec2 depth = near_far(at);
#ifdef EDGES
  if (depth.x == depth.y) discard;
#endif
  gl_FragDepth = depth.x == depth.y ? depth_range.x : 0.5 * (depth.x + depth.y);
#endif
  result = texelFetch(layer, at, 0);
  if (result.a == 0.0) discard;
  result.rgb = min(result.rgb * gain, vec3(1.0));
}
)glsl";

/// Returns the minimum and maximum depth of the samples of each pixel.
inline constexpr char kVolumeExtremesFragmentShader[] = R"glsl(
uniform sampler2DMS depths;
uniform int samples;
out vec2 result;
void main() {
  float least = 1.0, most = 0.0;
  for (int i = 0; i < samples; ++i) {
    float depth = texelFetch(depths, ivec2(gl_FragCoord.xy), i).r;
    least = min(least, depth);
    most = max(most, depth);
  }
  result = vec2(least, most);
}
)glsl";

/// Layout of the items, before kItemsShader. volume_gl.cpp writes `items`.
inline constexpr char kVolumeItemShader[] = R"glsl(
const int ROW_X = 0, ROW_Y = 1, ROW_Z = 2, NORMAL_X = 3, NORMAL_Y = 4, NORMAL_Z = 5, LOWER = 6, STEP = 7, PLACE = 8,
          SIZE = 9, WEIGHT = 10, CLIP = 11, SHADE = 12, COLOR = 13, SCALE = 14, FOG = 15, LIGHTS = 19,
          TRANSFER = LIGHTS + 5 * MOST_LIGHTS;
)glsl";

/// Decodes the positions of vectors.
inline constexpr char kVolumeDataShader[] = R"glsl(
vec3 position_of(int item, uvec4 code) {
  return about(item, LOWER).xyz + vec3(code.xyz & 0xFFFFFu) * about(item, STEP).xyz;
}
)glsl";

/// Computes and lights the colour of a vector, in the order of volume_model.h.
inline constexpr char kVolumeShadeShader[] = R"glsl(
vec3 normal_of(uvec4 code) {
  uvec2 c = (code.xy >> 20) & 1023u;
  if (c.x == 1023u) return vec3(0.0);
  vec3 n = vec3(vec2(c) / 511.0 - 1.0, 0.0);
  n.z = 1.0 - abs(n.x) - abs(n.y);
  float fold = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -fold : fold;
  n.y += n.y >= 0.0 ? -fold : fold;
  return normalize(n);
}

float weight_of(int item, uvec4 code) {
  uint c = code.x >> 30 | (code.y >> 30) << 2 | (code.z >> 20) << 4;
  vec2 coding = about(item, WEIGHT).xy;
  return c == 0u ? 0.0 : exp2(coding.x + float(c) * coding.y);
}

vec3 hue_color(float hue, float value) {
  hue = fract(hue) * 6.0;
  vec3 away = abs(hue - vec3(0.0, 2.0, 4.0));
  return clamp(2.0 - min(away, 6.0 - away), 0.0, 1.0) * value;
}
vec3 ramp_color(float part) { return hue_color((1.0 - clamp(part, 0.0, 1.0)) * (2.0 / 3.0), 1.0); }
float octave_of(int index) {
  int octave = 0;
  for (int end = FIRST_OCTAVE; index >= end && octave < 24; end *= 2) ++octave;
  return float(octave);
}

vec3 color_of(int item, int index, uvec4 code, vec3 normal) {
  vec4 chosen = about(item, COLOR);
  int by = int(chosen.w);  // a ColorBy; 5: the colour `chosen`; 6: colours of the vectors
  int last = whole(about(item, SIZE).xy) - 1;
  if (by == 1) return normal * 0.5 + 0.5;
  if (by == 2) return last < FIRST_OCTAVE ? ramp_color(1.0) : ramp_color(octave_of(index) / octave_of(last));
  if (by == 3) {
    int block = index / BLOCK_VECTORS;
    return hue_color(float(block) * 0.618033988749894848, block % 2 == 0 ? 1.0 : 0.75);
  }
  if (by == 4) return ramp_color(last > 0 ? float(index) / float(last) : 0.0);
  if (by == 5) return chosen.rgb;
  if (by == 6) return vec3(code.w & 255u, code.w >> 8 & 255u, code.w >> 16 & 255u) / 255.0;
  return about(item, TRANSFER + int(code.w >> 24)).rgb;
}

float spot_of(vec4 direction_cut, float beam_width, vec3 to_light) {
  float cut = direction_cut.w;
  if (cut >= PI) return 1.0;
  float angle = acos(clamp(-dot(direction_cut.xyz, to_light), -1.0, 1.0));
  if (angle >= cut) return 0.0;
  if (angle <= beam_width || !(beam_width < cut)) return 1.0;
  return (angle - cut) / (beam_width - cut);
}

vec3 shade(int item, vec3 color, vec3 seen, vec3 normal) {
  vec4 shading = about(item, SHADE);  // weights: ambient, diffuse, specular; number of lights
  bool facing = dot(normal, normal) > 0.0;
  vec3 n = facing ? normalize(normal) : vec3(0.0);
  vec3 to_viewer = -normalize(seen);
  vec3 diffuse = vec3(0.0), gloss = vec3(0.0);
  for (int i = 0; i < int(shading.w); ++i) {
    int at = LIGHTS + 5 * i;
    vec4 place = about(item, at), tint = about(item, at + 1), fade = about(item, at + 2);
    vec3 to_light = place.xyz;
    float strength = 1.0;
    if (place.w == 0.0) {  // point or spot light
      vec4 direction_cut = about(item, at + 3), more = about(item, at + 4);
      to_light -= seen;
      float far = length(to_light);
      if (!(far <= fade.w)) continue;
      to_light = far > 0.0 ? to_light / far : to_viewer;
      strength = spot_of(direction_cut, more.x, to_light) / max(fade.x + fade.y * far + fade.z * far * far, 1.0);
    }
    float falls = facing ? abs(dot(n, to_light)) : 1.0;
    diffuse += tint.rgb * (strength * (shading.x + shading.y * falls + tint.a));
    vec3 middle = to_light + to_viewer;
    float middle2 = dot(middle, middle);
    if (!facing || !(middle2 > 0.0)) continue;
    float shine = dot(n, middle);
    shine = shine * shine / middle2;
    shine *= shine; shine *= shine; shine *= shine;
    gloss += tint.rgb * (strength * shading.z * shine);
  }
  color = clamp(color * diffuse + gloss, 0.0, 1.0);
  return fogged(item, FOG, color, seen);
}
)glsl";

/// Writes the sort keys of vectors, after the shaders above and kSortKeysShader.
inline constexpr char kVolumeKeysShader[] = R"glsl(
void main() {
  for (uint k = 0u; k < EACH; ++k) {
    int number = number_of(k);
    if (number < 0) return;
    Place place = place_of(number);
    vec3 position = position_of(place.item, texelFetch(codes, place.first + place.index));
    write_key(k, -dot(about(place.item, ROW_Z), vec4(position, 1.0)));
  }
}
)glsl";

/// Draws a rectangle for each vector that faces the viewer, after kRankShader.
inline constexpr char kVolumeVertexShader[] = R"glsl(
uniform samplerBuffer spacings;
uniform vec4 lens;  // xy: pixels per length 1 at depth 1; zw: size of the viewport
uniform vec2 straight;  // position of the optical axis, in pixels from the middle
uniform vec4 depth_range;  // near plane; clip_from_camera[2][2] and [3][2]; minimum depth of clip space
uniform float farthest;  // maximum depth
uniform float gain;  // factor of the colours
flat out vec4 color;
out vec2 away;  // distance from the centre, in units of sqrt(A)

void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // out of view
  color = vec4(0.0);
  away = vec2(0.0);
  Place place = place_of(number_at(gl_InstanceID));
  int item = place.item, texel = place.first + place.index;
  uvec4 code = texelFetch(codes, texel);
  vec4 scale = about(item, SCALE);  // factor of lengths; minimum, full magnitude; opacity / (pi kVolumeFootprint)
  float weight = weight_of(item, code);
  if (!(weight >= scale.y)) return;
  vec4 position = vec4(position_of(item, code), 1.0);
  vec4 clip = about(item, CLIP);
  if (!(dot(clip, position) >= 0.0)) return;
  float thickness = about(item, TRANSFER + int(code.w >> 24)).w;
  float alpha = min(scale.w * thickness * (weight < scale.z ? weight / scale.z : 1.0), MOST_ALPHA);
  vec3 seen = vec3(dot(about(item, ROW_X), position), dot(about(item, ROW_Y), position),
                   dot(about(item, ROW_Z), position));
  float depth = -seen.z, spacing = texelFetch(spacings, texel).r * scale.x;
  if (!(alpha >= LEAST_ALPHA && depth > depth_range.x && depth <= farthest && depth > spacing)) return;
  float near = 1.0 / depth, pixels = sqrt(lens.x * lens.y) * near;
  float area = FOOTPRINT * spacing * spacing * pixels * pixels;
  if (area < LEAST_AREA) {
    alpha *= area / LEAST_AREA;
    area = LEAST_AREA;
    if (!(alpha >= LEAST_ALPHA)) return;
  }
  vec3 normal = normal_of(code);
  vec3 turned = vec3(dot(about(item, NORMAL_X).xyz, normal), dot(about(item, NORMAL_Y).xyz, normal),
                     dot(about(item, NORMAL_Z).xyz, normal));
  color = vec4(shade(item, color_of(item, place.index, code, normal), seen, turned) * gain, alpha);
  away = (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0) * CUT;
  vec2 center = seen.xy * near * lens.xy + straight;  // pixels from the middle of the viewport
  gl_Position.xy = (center + away * sqrt(area)) * 2.0 / lens.zw;
  gl_Position.z = clamp(depth_range.z * near - depth_range.y, depth_range.w, 1.0);
}
)glsl";

inline constexpr char kVolumeFragmentShader[] = R"glsl(
flat in vec4 color;
in vec2 away;
out vec4 result;
void main() {
  float alpha = color.a * exp(-dot(away, away));
  result = vec4(color.rgb * alpha, alpha);
}
)glsl";

}  // namespace gs::render
