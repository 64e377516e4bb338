#pragma once

#include "render/rays/splat_pick.h"

namespace gs::render {

/// Returns the depth at which Gaussians absorb half of the light of a ray, and the colour of the splat there (of degree
/// 0). Returns nullopt if the whole ray absorbs less than half. Tests all splats. Accepts any numbers and any affine
/// matrix. Thread-safe.
[[nodiscard]] std::optional<DiscPick> pick_gaussians(const qnv::Gaussians& gaussians, const glm::dmat4& world_from_node,
                                                     const PickRay& ray, const PickLimits& limits = {});

}  // namespace gs::render
