#pragma once

/// Constants that the CPU and GPU splatters share, so that they draw the same image.
namespace gs::render::splat {

// For splats of an octree, as fractions of the cube's edge: margin of a back face, and margin that closes gaps between
// planes. kCubeBell: radius of the bell, relative to a disc of equal area.
inline constexpr float kBackMargin = -0.1f, kCubeMargin = 0.1f, kCubeBell = 1.2f;
// Margin in samples for cubes of one or two samples. It prevents pinholes between their planes that are seen from the
// side.
inline constexpr float kSampleMargin = 0.35f;
// For other splats, as multiples of the radius: range that a splat covers, and radius of its bell. Neighbours overlap,
// which prevents pinholes.
inline constexpr float kDiscCover = 1.7f, kDiscBell = 1.4f;
inline constexpr float kMinReach = 0.6f;  // minimum reach in samples, so that no small splat falls between samples
inline constexpr float kGrazing = 0.02f;  // minimum cosine of the angle between ray and normal
// Mean splat size in samples above which normals follow the surface between the splats.
inline constexpr float kSmoothFrom = 2.5f;
// Weight of the slope of the blended surface in its normal. The blended normals have weight 1.
inline constexpr float kSmoothing = 0.5f;
inline constexpr float kPi = 3.14159265f;

}  // namespace gs::render::splat
