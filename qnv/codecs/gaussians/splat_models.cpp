#include "qnv/codecs/gaussians/splat_models.h"

#include <cstring>
#include <iterator>
#include <type_traits>

namespace gs::qnv::gaussians {
namespace {

/// Probabilities at the start of a stream, in 1/256, in the order of the members of SplatModels. 0 marks a model that
/// starts like those of untrained streams.
constexpr std::uint8_t kPriors[] = {
#include "qnv/codecs/gaussians/splat_priors.inc"
};
// Decisions that a trained model counts as seen.
constexpr std::uint8_t kPriorSeen = 20;
constexpr std::size_t kTrainedCount = offsetof(SplatModels, former) / sizeof(BitModel);
static_assert(std::size(kPriors) == kTrainedCount);
static_assert(std::is_trivially_copyable_v<SplatModels> && std::is_standard_layout_v<SplatModels>);

}  // namespace

SplatModels::SplatModels(bool from_table) : trained(from_table ? 1 : 0) {
  if (!from_table) return;
  auto* const bytes = reinterpret_cast<std::byte*>(this);
  for (std::size_t i = 0; i < kTrainedCount; ++i) {
    if (kPriors[i] == 0) continue;
    const BitModel model{static_cast<std::uint16_t>(kPriors[i] << 8), kPriorSeen};
    std::memcpy(bytes + i * sizeof model, &model, sizeof model);
  }
}

}  // namespace gs::qnv::gaussians
