#pragma once

// GLSL of ClipPlanes, ShapeStyles, LocalFogs and FogCoordinates, for all shaders of meshes.
namespace gs::render {

/// Part of a vertex shader. Defines: FOG; MOST_PLANES: maximum number of ClipPlanes.
inline constexpr char kStyleVertexShader[] = R"glsl(
layout(location = 15) in float fog_depth;  // negative if the mesh has no fog depths
uniform vec4 clip_planes[MOST_PLANES];     // in camera space
uniform vec4 point_size;                   // size, least and largest size, in samples
uniform vec3 point_attenuation;
out float gl_ClipDistance[MOST_PLANES];
out float line_place;  // line widths from the start of the polyline
#ifdef FOG
out float vertex_fog;
#endif

// `place` is in camera space; `along` is the distance from the start of the polyline.
void apply_style(vec3 place, float along) {
  for (int i = 0; i < MOST_PLANES; ++i) gl_ClipDistance[i] = dot(clip_planes[i], vec4(place, 1.0));
  float r = length(place);
  float attenuation = max(dot(point_attenuation, vec3(1.0, r, r * r)), 1e-6);
  gl_PointSize = clamp(point_size.x / attenuation, point_size.y, point_size.z);
  line_place = along;
#ifdef FOG
  vertex_fog = fog_depth;
#endif
}
)glsl";

/// Part of a fragment shader, after kFogShader. Defines: FOG, TEXTURE.
inline constexpr char kStyleFragmentShader[] = R"glsl(
in float line_place;
uniform int line_pattern;  // bits of a period; -1 if the line is solid
uniform int hatch[32];     // rows of the hatches
uniform vec4 hatch_color;  // w: 0 without hatches, 1 with hatches on a surface, 2 with hatches only
uniform float pixel_side;  // samples along the side of a pixel
#ifdef FOG
in float vertex_fog;
#endif

#ifdef TEXTURE
uniform mat3 texture_transform;
uniform bool sprite;  // the texture covers each point
vec2 place_in_image(vec2 place) {
  if (!sprite) return place;
  vec2 at = (texture_transform * vec3(gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1.0)).xy;
  return vec2(at.x, 1.0 - at.y);
}
#endif

// Discards gaps of lines and hatches. Returns the colour with hatches and fog.
vec4 styled(vec4 color, vec3 place) {
  if (line_pattern != -1 && (uint(line_pattern) >> (uint(max(line_place, 0.0)) & 31u) & 1u) == 0u) discard;
  if (hatch_color.w > 0.0) {
    ivec2 pixel = ivec2(gl_FragCoord.xy / pixel_side) & 31;
    bool inside = (uint(hatch[pixel.y]) >> uint(pixel.x) & 1u) != 0u;
    if (!inside && hatch_color.w > 1.0) discard;
    if (inside) color = vec4(hatch_color.rgb, 1.0);
  }
#ifdef FOG
  color.rgb = fogged_at(color.rgb, vertex_fog < 0.0 ? fog_distance(place) : min(vertex_fog, 1.0));
#endif
  return color;
}
)glsl";

}  // namespace gs::render
