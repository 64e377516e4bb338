#pragma once

#include "qnv/codecs/gaussians/splat_code.h"
#include "qnv/codecs/gaussians/splat_models.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Largest number of children of a Gaussian. One child means that the Gaussian stays, and is not coded again.
inline constexpr std::size_t kMostChildren = 255;

/// Codes a Gaussian, and returns its shape. With a Writer, `code` is the input; with a Reader, it is the result.
/// `sibling` is the previous Gaussian with the same parent, or null.
template <class Coder>
SplatShape code_splat(Coder& coder, SplatModels& models, const SplatNode& parent, const SplatFrame& frame,
                      const SplatCode* sibling, SplatCode& code, const Precision& precision) {
  code.leaf = coder.bit(models.leaf[sibling ? (sibling->leaf ? 2 : 1) : 0], code.leaf);
  const std::size_t leaf = code.leaf ? 1 : 0, beside = sibling ? 1 : 0;
  // Gaussians that will be replaced have half the precision.
  const int coarse = code.leaf ? 0 : 1;
  const int scale = (sibling ? sibling->scales[0] : parent.scales[0] - kScaleSteps) >> coarse;
  TypicalSize& scale_size = models.scale_size[leaf][beside];
  const int change = models.size[leaf][beside].code(coder, scale_size.size(), (code.scales[0] >> coarse) - scale);
  scale_size.learn(change);
  code.scales[0] = std::clamp(scale + change, 0, kMostScale >> coarse) << coarse;
  for (std::size_t k = 1; k < 3; ++k) {
    const int known = sibling ? sibling->scales[k - 1] - sibling->scales[k] : parent.scales[k - 1] - parent.scales[k];
    const auto about = static_cast<std::size_t>(std::min(
        static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(known, 0)) / 4u)) + (sibling ? 1 : 0), 5));
    const int gap = static_cast<int>(models.gaps[k - 1][leaf][about].code(
        coder, static_cast<std::uint32_t>((code.scales[k - 1] - code.scales[k]) >> coarse)));
    code.scales[k] = std::max(code.scales[k - 1] - (std::min(gap, kMostScale) << coarse), 0);
  }
  const int opacity = (sibling ? sibling->opacity : parent.opacity) >> coarse;
  TypicalSize& opacity_size = models.opacity_size[leaf][beside];
  const int lighter = models.opacity[leaf][beside].code(coder, opacity_size.size(), (code.opacity >> coarse) - opacity);
  opacity_size.learn(lighter);
  code.opacity = std::clamp((opacity + lighter) << coarse | coarse, 1, kMostOpacity);

  const SplatSteps steps = steps_of(code, precision);
  for (std::size_t k = 0; k < 3; ++k)
    code.turn[k] = std::clamp(models.turn[leaf][k].code(coder, size_of(0.25 / steps.turn[k]), code.turn[k]), -kMostTurn,
                              kMostTurn);
  const glm::vec4 rotation = turned(parent.rotation, code.turn, steps.turn);
  const SplatAxes axes = axes_of(rotation);
  const auto spread = place_spread(frame, axes, steps);
  for (std::size_t k = 0; k < 3; ++k)
    code.place[k] =
        std::clamp(models.place[leaf].code(coder, size_of(spread[k]), code.place[k]), -kMostPlace, kMostPlace);
  for (std::size_t k = 0; k < 3; ++k) {
    TypicalSize& color_size = models.color_size[leaf][k];
    code.color[k] =
        std::clamp(models.color[leaf][k].code(coder, color_size.size(), code.color[k]), -kMostColor, kMostColor);
    color_size.learn(code.color[k]);
  }
  return {steps, rotation, axes};
}

/// Codes the children of a Gaussian, which must not be a leaf, and appends the decoded ones to `nodes`. If `may_stay`,
/// a single child is the Gaussian itself, without code. With a Writer, `children` is the input; with a Reader, its size
/// is irrelevant. Returns the number of children.
template <class Coder>
std::size_t code_children(Coder& coder, SplatModels& models, const SplatNode& parent, bool may_stay,
                          std::span<SplatCode> children, const Precision& precision, std::vector<SplatNode>& nodes) {
  const std::uint32_t more = models.children.code(coder, static_cast<std::uint32_t>(children.size()) - 1);
  const std::size_t count = std::min<std::size_t>(more, kMostChildren - 1) + 1;
  if (may_stay && count == 1) {
    nodes.push_back(parent);
    return count;
  }
  const SplatFrame frame = frame_of(parent);
  std::array<SplatCode, 2> read;  // with a Reader: this child and the previous one in turn
  const SplatCode* sibling = nullptr;
  for (std::size_t i = 0; i < count; ++i) {
    SplatCode& code = Coder::kWrites ? children[i] : read[i % 2];
    const SplatShape shape = code_splat(coder, models, parent, frame, sibling, code, precision);
    nodes.push_back(node_of(parent, code, shape, precision));
    sibling = &code;
  }
  return count;
}

}  // namespace gs::qnv::gaussians
