#pragma once

/// What the splatters on the processor and on the GPU share, so that they draw the same picture.
namespace gs::render::splat {

// Discs of an octree cover their cube and this part of its edge more, so that planes that do not quite meet leave no
// gap; their bell has this many times the radius of a disc of their area.
inline constexpr float kBackMargin = -0.1f, kCubeMargin = 0.1f, kCubeBell = 1.2f;
// Cubes of a sample or two cover so many samples more, or their planes would leave pinholes where they are seen from
// the side.
inline constexpr float kSampleMargin = 0.35f;
// Other discs cover and blend within these many times that radius: neighbours overlap, so that no pinholes are left.
inline constexpr float kDiscCover = 1.7f, kDiscBell = 1.4f;
inline constexpr float kLeastReach = 0.6f;  // samples: what is smaller is drawn so large, so that it is not missed
inline constexpr float kGrazing = 0.02f;    // discs seen edge on up to this cosine are left out
// Where discs are wider than this on average, in samples, normals follow the surface between them.
inline constexpr float kSmoothFrom = 2.5f;
// How much of the slope of the blended surface goes into its normal, beside the blended normals themselves.
inline constexpr float kSmoothing = 0.5f;
inline constexpr float kPi = 3.14159265f;

}  // namespace gs::render::splat
