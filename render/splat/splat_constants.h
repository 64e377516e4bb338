#pragma once

/// Constants shared by the CPU and GPU splatters, so that they draw the same image.
namespace gs::render::splat {

// Splats of an octree cover their cube plus this fraction of its edge, so that planes that do not quite touch leave no
// gap. Their bell has this many times the radius of a disc of equal area.
inline constexpr float kBackMargin = -0.1f, kCubeMargin = 0.1f, kCubeBell = 1.2f;
// Margin in samples for cubes of one or two samples, so that no pinholes appear between their planes when seen from the
// side.
inline constexpr float kSampleMargin = 0.35f;
// Other splats cover and blend within these multiples of their radius; neighbours overlap, which leaves no pinholes.
inline constexpr float kDiscCover = 1.7f, kDiscBell = 1.4f;
inline constexpr float kMinReach = 0.6f;  // samples: minimum size, so that small splats are not missed
inline constexpr float kGrazing = 0.02f;  // splats seen edge-on up to this cosine are skipped
// Mean splat size, in samples, above which normals follow the surface between splats.
inline constexpr float kSmoothFrom = 2.5f;
// Weight of the blended surface's slope in its normal, besides the blended normals.
inline constexpr float kSmoothing = 0.5f;
inline constexpr float kPi = 3.14159265f;

}  // namespace gs::render::splat
