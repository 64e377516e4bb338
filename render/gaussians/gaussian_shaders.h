#pragma once

/// Shaders of Gaussians. make_program adds "#version 330 core" before those that draw.
namespace gs::render {

/// Layout of the items, before kItemsShader. gaussian_gl.cpp writes `items`.
inline constexpr char kGaussianItemShader[] = R"glsl(
const int ROW_X = 0, ROW_Y = 1, ROW_Z = 2, EYE = 3, METRIC = 4, PLACE = 7, FORM = 8, CLIP = 9, FOG = 10;
)glsl";

/// Writes the sort keys of splats: squared distances from the eye. After the shaders above and kSortKeysShader.
inline constexpr char kGaussianKeysShader[] = R"glsl(
void main() {
  for (uint k = 0u; k < EACH; ++k) {
    int number = number_of(k);
    if (number < 0) return;
    Place place = place_of(number);
    int stride = int(about(place.item, FORM).x);
    vec3 away = uintBitsToFloat(texelFetch(codes, place.first + place.index * stride).xyz) -
                about(place.item, EYE).xyz;
    vec3 product = vec3(dot(about(place.item, METRIC).xyz, away), dot(about(place.item, METRIC + 1).xyz, away),
                        dot(about(place.item, METRIC + 2).xyz, away));
    write_key(k, dot(away, product));
  }
}
)glsl";

/// Decodes the texels of gaussian_store.h, and evaluates harmonics as gaussian_harmonics.h.
inline constexpr char kGaussianDataShader[] = R"glsl(
float signed_part(uint code) { return float(int(code << 16) >> 16) * (1.0 / 32767.0); }
float rotation_part(uint code) { return (float(code & 0x7FFFu) * (2.0 / 32766.0) - 1.0) * 0.70710678; }
float scale_of(uint code, vec2 coding) {
  code &= 0xFFFFu;
  return code == 0u ? 0.0 : exp2(coding.x + float(code) * coding.y);
}

// Returns the axes of a splat.
mat3 rotation_of(uint a, uint b, uint c) {
  vec3 parts = vec3(rotation_part(a), rotation_part(b), rotation_part(c));
  float w = sqrt(max(1.0 - dot(parts, parts), 0.0));
  uint largest = (a >> 15 & 1u) | (b >> 15 & 1u) << 1;
  vec4 q = largest == 0u ? vec4(w, parts)
         : largest == 1u ? vec4(parts.x, w, parts.yz)
         : largest == 2u ? vec4(parts.xy, w, parts.z) : vec4(parts, w);
  vec3 q2 = q.xyz * q.xyz;
  float xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return mat3(1.0 - 2.0 * (q2.y + q2.z), 2.0 * (xy + wz), 2.0 * (xz - wy),
              2.0 * (xy - wz), 1.0 - 2.0 * (q2.x + q2.z), 2.0 * (yz + wx),
              2.0 * (xz + wy), 2.0 * (yz - wx), 1.0 - 2.0 * (q2.x + q2.y));
}

// Adds two coefficients with their weights. The last texel has only one.
vec3 pair(int texel, float first, float second) {
  uvec4 code = texelFetch(codes, texel);
  return first * vec3(signed_part(code.x), signed_part(code.x >> 16), signed_part(code.y)) +
         second * vec3(signed_part(code.z), signed_part(code.z >> 16), signed_part(code.w));
}
vec3 harmonics(int degree, int texel, vec3 d) {
  float x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
  if (degree == 0) return vec3(0.0);
  vec3 sum = pair(texel, -0.48860251 * y, 0.48860251 * z);
  if (degree == 1) return sum + pair(texel + 1, -0.48860251 * x, 0.0);
  sum += pair(texel + 1, -0.48860251 * x, 1.09254843 * x * y);
  sum += pair(texel + 2, -1.09254843 * y * z, 0.31539157 * (2.0 * zz - xx - yy));
  sum += pair(texel + 3, -1.09254843 * x * z, 0.54627422 * (xx - yy));
  if (degree == 2) return sum;
  sum += pair(texel + 4, -0.59004359 * y * (3.0 * xx - yy), 2.89061144 * x * y * z);
  sum += pair(texel + 5, -0.45704580 * y * (4.0 * zz - xx - yy), 0.37317633 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy));
  sum += pair(texel + 6, -0.45704580 * x * (4.0 * zz - xx - yy), 1.44530572 * z * (xx - yy));
  return sum + pair(texel + 7, -0.59004359 * x * (xx - 3.0 * yy), 0.0);
}
)glsl";

/// Projects splats as project_gaussians() defines it. Needs SURFELS if a splat is flat. After kItemsShader and
/// kGaussianDataShader.
inline constexpr char kGaussianProjectionShader[] = R"glsl(
uniform vec4 lens;  // xy: pixels per length 1 at depth 1; zw: size of the viewport
uniform vec4 limits;  // of the tangents at which the projection is linearised: left, low, right, high
uniform vec2 straight;  // position of the optical axis, in pixels from the middle
uniform vec4 depth_range;  // near plane; clip_from_camera[2][2] and [3][2]; minimum depth of clip space
uniform float farthest;  // maximum depth

// Rectangle of a splat. Its corners are center +- major +- minor.
struct Rectangle {
  vec2 center, major, minor;  // pixels; the center from the middle of the viewport
  float depth;  // in clip space
  float root;  // half size in standard deviations
  vec4 color;  // w: logarithm of the opacity to the base 2
#ifdef SURFELS
  bool is_surfel;
  mat3 lines;  // a pixel's plane coordinates are xy / z of lines * (pixels from the center, 1)
#endif
};

// Sets the rectangle along the axes of an ellipse, by EWA, its half size along the axes of the viewport, and the
// opacity. Returns false if the splat is invisible.
bool ellipse(mat3 linear, vec3 scales, vec2 pixels, vec2 along, bool antialiased, inout float opacity, out vec2 extent,
             inout Rectangle result) {
  float xx = 0.0, xy = 0.0, yy = 0.0;
  extent = vec2(0.0);
  for (int k = 0; k < 3; ++k) {
    vec3 axis = linear[k] * scales[k];
    vec2 uv = pixels * axis.xy + along * axis.z;
    xx += uv.x * uv.x;
    xy += uv.x * uv.y;
    yy += uv.y * uv.y;
  }
  float sharp = xx * yy - xy * xy;
  xx += LOW_PASS;
  yy += LOW_PASS;
  float determinant = xx * yy - xy * xy;
  if (!(determinant > 0.0 && determinant < 1e30)) return false;
  if (antialiased) opacity *= sqrt(max(sharp, 0.0) / determinant);
  if (!(opacity >= LEAST_ALPHA)) return false;
  opacity = min(opacity, 1.0);
  float inside = 2.0 * log(opacity / LEAST_ALPHA);
  extent = sqrt(inside * vec2(xx, yy));
  // The axes of the ellipse: eigenvectors of the covariance.
  float half_difference = 0.5 * (xx - yy), root = sqrt(half_difference * half_difference + xy * xy);
  float most = 0.5 * (xx + yy) + root, least = determinant / most;
  vec2 axis = half_difference >= 0.0 ? vec2(half_difference + root, xy) : vec2(xy, root - half_difference);
  float size = length(axis);
  axis = size > 0.0 ? axis / size : vec2(1.0, 0.0);
  result.root = sqrt(inside);
  result.major = axis * (result.root * sqrt(most));
  result.minor = vec2(-axis.y, axis.x) * (result.root * sqrt(least));
  return true;
}

#ifdef SURFELS
// Sets the rectangle of a surfel, and where rays meet the plane; see gaussian_projection.cpp. Returns false if the
// surfel reaches the plane of the eye.
bool surfel(mat3 linear, vec3 scales, vec3 seen, float opacity, out vec2 extent, inout Rectangle result) {
  vec3 u = linear[0] * scales.x, v = linear[1] * scales.y, depth = -vec3(u.z, v.z, seen.z);
  vec2 slope = seen.xy / -seen.z;
  vec3 x = lens.x * (vec3(u.x, v.x, seen.x) - slope.x * depth), y = lens.y * (vec3(u.y, v.y, seen.y) - slope.y * depth);
  float inside = 2.0 * log(min(opacity, 1.0) / LEAST_ALPHA), across = inside * dot(depth.xy, depth.xy);
  extent = vec2(0.0);
  if (!(across < depth.z * depth.z * 0.99)) return false;
  float scale = inside / (across - depth.z * depth.z);
  vec2 middle = scale * vec2(dot(x.xy, depth.xy), dot(y.xy, depth.xy));
  vec2 wide = sqrt(middle * middle - scale * vec2(dot(x.xy, x.xy), dot(y.xy, y.xy)));
  extent = max(abs(middle) + wide, vec2(sqrt(inside / SURFEL_SCREEN)));
  mat3 lines = mat3(cross(y, depth), cross(depth, x), cross(x, y));
  vec3 sizes = max(max(abs(lines[0]), abs(lines[1])), abs(lines[2]));
  float most = max(max(sizes.x, sizes.y), sizes.z);
  if (!(most > 0.0 && most < 1e30)) return false;
  result.root = 1.0;
  result.major = vec2(extent.x, 0.0);
  result.minor = vec2(0.0, extent.y);
  result.is_surfel = true;
  result.lines = lines / most;
  return true;
}
#endif

// Projects a splat. Returns false if it is invisible.
bool project(int number, out Rectangle result) {
  result.center = result.major = result.minor = vec2(0.0);
  result.depth = result.root = 0.0;
  result.color = vec4(0.0);
#ifdef SURFELS
  result.is_surfel = false;
  result.lines = mat3(0.0);
#endif
  Place place = place_of(number);
  int item = place.item;
  vec4 form = about(item, FORM);  // texels of a splat, degree, limit of the coefficients, 1 if antialiased
  int texel = place.first + place.index * int(form.x);
  uvec4 code = texelFetch(codes, texel);
  vec4 eye = about(item, EYE);  // w: factor of the opacity
  float opacity = float(code.w & 0xFFFFu) * (1.0 / 65535.0) * eye.w, presence = about(item, FOG + 3).z;
  if (presence < 1.0) {
    float most = min(opacity, MOST_ALPHA);
    opacity = 1.0 - pow(1.0 - most * presence, 1.0 + FADE_GAIN * presence * (1.0 - presence) * most);
  }
  if (!(opacity >= LEAST_ALPHA)) return false;
  vec4 position = vec4(uintBitsToFloat(code.xyz), 1.0);
  if (!(dot(about(item, CLIP), position) >= 0.0)) return false;
  vec4 row_x = about(item, ROW_X), row_y = about(item, ROW_Y), row_z = about(item, ROW_Z);
  vec3 seen = vec3(dot(row_x, position), dot(row_y, position), dot(row_z, position));
  float depth = -seen.z;
  if (!(depth > depth_range.x && depth <= farthest && depth > 0.0)) return false;
  uvec4 shape = texelFetch(codes, texel + 1);
  vec4 coding = vec4(about(item, METRIC).w, about(item, METRIC + 1).w, about(item, METRIC + 2).w, 0.0);
  float near = 1.0 / depth;
  vec2 pixels = lens.xy * near;
  vec2 along = pixels * clamp(seen.xy * near, limits.xy, limits.zw);
  mat3 turn = rotation_of(shape.z >> 16, shape.w & 0xFFFFu, shape.w >> 16);
  mat3 linear = transpose(mat3(row_x.xyz, row_y.xyz, row_z.xyz)) * turn;
  vec3 scales = vec3(scale_of(shape.x, coding.xy), scale_of(shape.x >> 16, coding.xy), scale_of(shape.y, coding.xy));
  result.center = seen.xy * pixels + straight;
  vec2 extent;
  bool is_visible = false;
#ifdef SURFELS
  bool is_flat = scales.z == 0.0 && scales.x > 0.0 && scales.y > 0.0;
  is_visible = is_flat && surfel(linear, scales, seen, opacity, extent, result);
#endif
  if (!is_visible) is_visible = ellipse(linear, scales, pixels, along, form.w != 0.0, opacity, extent, result);
  if (!is_visible) return false;
  if (!(max(extent.x, extent.y) < MOST_REACH)) return false;
  if (!(all(lessThanEqual(abs(result.center) - extent, 0.5 * lens.zw)))) return false;

  vec3 towards = position.xyz - eye.xyz;
  float distance = length(towards);
  vec3 base = vec3(signed_part(code.w >> 16), signed_part(shape.y >> 16), signed_part(shape.z)) * coding.z;
  vec3 own = base;
  if (distance > 0.0) own += form.z * harmonics(int(form.y), texel + 2, towards / distance);
  own = max(own, vec3(0.0));
  result.color = vec4(fogged(item, FOG, own, seen), log2(min(opacity, 1.0)));
  result.depth = clamp(depth_range.z * near - depth_range.y, depth_range.w, 1.0);
  return true;
}
)glsl";

/// Writes the rectangles of all splats, in sorted order, as three texels each. An invisible splat has the root 0. After
/// kRankShader and kGaussianProjectionShader. Needs version 430.
inline constexpr char kGaussianRectanglesShader[] = R"glsl(
layout(local_size_x = 128) in;
layout(std430, binding = 1) writeonly buffer Rectangles { vec4 rectangles[]; };
uniform int count;
void main() {
  int rank = int(gl_GlobalInvocationID.x);
  if (rank >= count) return;
  Rectangle splat;
  if (!project(number_at(rank), splat)) splat.root = 0.0;
  rectangles[3 * rank] = vec4(splat.center, splat.depth, splat.root);
  rectangles[3 * rank + 1] = vec4(splat.major, splat.minor);
  rectangles[3 * rank + 2] = splat.color;
}
)glsl";

/// Reads the texels of kGaussianRectanglesShader instead of projecting splats.
inline constexpr char kGaussianReadShader[] = R"glsl(
uniform samplerBuffer rectangles;
uniform ivec2 ranks;
uniform vec4 lens;
struct Rectangle {
  vec2 center, major, minor;
  float depth, root;
  vec4 color;
};
int number_at(int rank) { return ranks.x + ranks.y * rank; }
bool project(int place, out Rectangle result) {
  vec4 first = texelFetch(rectangles, 3 * place);
  result.center = first.xy;
  result.depth = first.z;
  result.root = first.w;
  result.major = result.minor = vec2(0.0);
  result.color = vec4(0.0);
  if (!(first.w > 0.0)) return false;
  vec4 axes = texelFetch(rectangles, 3 * place + 1);
  result.major = axes.xy;
  result.minor = axes.zw;
  result.color = texelFetch(rectangles, 3 * place + 2);
  return true;
}
)glsl";

/// Draws the rectangles of splats, four vertices each. An instance has QUADS splats. After kRankShader and
/// kGaussianProjectionShader, or after kGaussianReadShader.
inline constexpr char kGaussianVertexShader[] = R"glsl(
uniform int count;
uniform float gain;
flat out vec4 color;  // w: logarithm of the opacity to the base 2
out vec2 away;  // from the centre, in standard deviations; of a surfel, those of its low-pass
#ifdef SURFELS
out vec3 hit;   // of a surfel: its plane coordinates are xy / z
#endif

void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // out of view
  color = vec4(0.0);
  away = vec2(0.0);
#ifdef SURFELS
  hit = vec3(0.0);
#endif
  int rank = gl_InstanceID * QUADS + (gl_VertexID >> 2);
  if (rank >= count) return;
  Rectangle splat;
  if (!project(number_at(rank), splat)) return;
  vec2 corner = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) * 2.0 - 1.0;
  vec2 offset = corner.x * splat.major + corner.y * splat.minor;
  away = corner * splat.root;
#ifdef SURFELS
  hit = vec3(away, 1.0);
  if (splat.is_surfel) {
    hit = splat.lines * vec3(offset, 1.0);
    away = offset * sqrt(SURFEL_SCREEN);
  }
#endif
  color = vec4(splat.color.rgb * gain, splat.color.w);
  gl_Position.xy = (splat.center + offset) * 2.0 / lens.zw;
  gl_Position.z = splat.depth;
}
)glsl";

inline constexpr char kGaussianFragmentShader[] = R"glsl(
flat in vec4 color;
in vec2 away;
#ifdef SURFELS
in vec3 hit;
#endif
out vec4 result;
void main() {
  float square = dot(away, away);
#ifdef SURFELS
  float below = hit.z * hit.z, top = dot(hit.xy, hit.xy);
  if (top < square * below) square = top / below;
#endif
  float power = color.w - 0.72134752 * square;  // 1/2 log2(e)
  if (power < LEAST_POWER) discard;
  float alpha = min(exp2(power), MOST_ALPHA);
  result = vec4(color.rgb * alpha, alpha);
}
)glsl";

}  // namespace gs::render
