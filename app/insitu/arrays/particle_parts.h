#pragma once

#include "app/insitu/arrays/field_view.h"
#include "app/insitu/arrays/ranks.h"
#include "app/insitu/arrays/step_plan.h"
#include "qnv/codecs/shared/encode_options.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::insitu {

/// Particles of the caller, with views of its arrays.
struct ParticlesView {
  gs_insitu_particles particles{};  // without fields
  std::vector<FieldView> fields;
};
/// Checks particles. Returns the problem if they are invalid.
[[nodiscard]] std::variant<ParticlesView, std::string> particles_view(const gs_insitu_particles& particles);

/// Particles of all ranks, on rank 0.
struct ParticleValues {
  FieldFacts field;
  std::array<double, 3> origin{};
  double radius = 0;         // 0 means that the density determines it
  std::uint32_t stride = 1;  // every n-th particle of each rank
  bool too_large = false;    // no particles: they exceed max_memory, or a rank lacks memory
  std::vector<ParticlePoint> points;
};

/// Extends the bounds of `facts` by particles.
void add_bounds(const ParticlesView& view, PartFacts& facts);
/// Collects particles on rank 0. Collective. Returns false if the communication failed.
[[nodiscard]] bool gather_particles(Ranks& ranks, std::span<const ParticlesView> parts, const StepPlan& plan,
                                    ParticleValues& values);
/// Encodes particles as Gaussians with colours for their values. Errors of positions are at most kParticleError.
/// Returns nullopt on success, else the problem.
[[nodiscard]] std::optional<std::string> encode_particles(const ParticleValues& particles, qnv::EncodeOptions options,
                                                          std::vector<std::byte>& bytes);
/// Maximum error of a position in radii, along each axis.
inline constexpr double kParticleError = 0.25;

}  // namespace gs::app::insitu
