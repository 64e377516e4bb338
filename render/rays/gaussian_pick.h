#pragma once

#include "render/rays/splat_pick.h"

#include <cstddef>
#include <span>

namespace gs::render {

/// Range of splats that a ray may hit.
struct GaussianPart {
  const qnv::Gaussians* gaussians = nullptr;
  std::size_t first = 0, count = 0;
};

/// Returns the depth at which Gaussians absorb half of the light of a ray, and the colour of the splat there (of degree
/// 0). Returns nullopt if the whole ray absorbs less than half. Tests all splats. Accepts any numbers and any affine
/// matrix. Thread-safe.
[[nodiscard]] std::optional<DiscPick> pick_gaussians(std::span<const GaussianPart> parts,
                                                     const glm::dmat4& world_from_node, const PickRay& ray,
                                                     const PickLimits& limits = {});
[[nodiscard]] inline std::optional<DiscPick> pick_gaussians(const qnv::Gaussians& gaussians,
                                                            const glm::dmat4& world_from_node, const PickRay& ray,
                                                            const PickLimits& limits = {}) {
  const GaussianPart all{&gaussians, 0, gaussians.size()};
  return pick_gaussians({&all, 1}, world_from_node, ray, limits);
}

}  // namespace gs::render
