#pragma once

#include "qnv/codecs/gaussians/splat_code.h"
#include "qnv/codecs/gaussians/splat_models.h"
#include "qnv/codecs/gaussians/splat_steps.h"

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

/// Codes the largest scale of a Gaussian.
template <class Coder>
void code_scale(Coder& coder, SplatModels& models, const SplatNode& parent, const SplatCode* sibling, SplatCode& code) {
  const std::size_t leaf = code.leaf ? 1 : 0, beside = sibling ? 1 : 0;
  const int coarse = code.leaf ? 0 : 1;
  int expected = parent.scales[0] - kScaleSteps;
  if (sibling) expected = models.trained ? (sibling->scales[0] + 3 * expected) >> 2 : sibling->scales[0];
  const int scale = expected >> coarse;
  TypicalSize& size = models.scale_size[leaf][beside];
  const int change = models.size[leaf][beside].code(coder, size.size(), (code.scales[0] >> coarse) - scale);
  size.learn(change);
  code.scales[0] = std::clamp(scale + change, 0, kMostScale >> coarse) << coarse;
}

/// Codes the smallest scale in a tuned stream: the cell of its gap to the middle scale. `known` predicts the gap.
template <class Coder>
void code_thin_gap(Coder& coder, SplatModels& models, int known, SplatCode& code) {
  constexpr int kEscape = 15;
  const std::size_t leaf = code.leaf ? 1 : 0;
  const int coarse = code.leaf ? 0 : 1;
  const int index = cell_index((code.scales[1] - code.scales[2]) >> coarse);
  const auto context =
      std::min<std::size_t>(static_cast<std::size_t>(cell_index(known >> coarse)) / 2, TrainedModels::kContexts - 1);
  auto coded = static_cast<int>(
      models.own.gaps[1][leaf].code_short(coder, context, static_cast<std::uint32_t>(std::min(index, kEscape))));
  if (coded == kEscape) {
    const std::uint32_t far = models.own.far_gaps[1].code(coder, static_cast<std::uint32_t>(index - kEscape));
    coded += static_cast<int>(std::min(far, static_cast<std::uint32_t>(kMostScale)));
  }
  code.scales[2] = std::max(code.scales[1] - (gap_cell(coded).middle() << coarse), 0);
}

/// Codes the other scales of a Gaussian by their differences.
template <class Coder>
void code_gaps(Coder& coder, SplatModels& models, const SplatNode& parent, const SplatCode* sibling, SplatCode& code,
               const Precision& precision) {
  const std::size_t leaf = code.leaf ? 1 : 0;
  const int coarse = code.leaf ? 0 : 1;
  for (std::size_t k = 1; k < 3; ++k) {
    const int inherited = std::max(parent.scales[k - 1] - parent.scales[k], 0);
    const int beside = sibling ? std::max(sibling->scales[k - 1] - sibling->scales[k], 0) : 0;
    const auto gap = static_cast<std::uint32_t>((code.scales[k - 1] - code.scales[k]) >> coarse);
    std::uint32_t coded = 0;
    if (models.trained) {
      using Tree = TreeModel<TrainedModels::kContexts>;
      const int known = sibling ? (inherited + beside) / 2 : inherited;
      if (k == 2 && precision.tuned()) return code_thin_gap(coder, models, known, code);
      const auto context = std::min<std::size_t>(static_cast<std::size_t>(known) / 6, TrainedModels::kContexts - 1);
      coded = models.own.gaps[k - 1][leaf].code(coder, context, std::min(gap, Tree::kMost));
      if (coded == Tree::kMost) coded += models.own.far_gaps[k - 1].code(coder, gap - Tree::kMost);
    } else {
      const int known = sibling ? beside : inherited;
      const int about = static_cast<int>(std::bit_width(static_cast<unsigned>(known) / 4u)) + (sibling ? 1 : 0);
      coded = models.former.gaps[k - 1][leaf][static_cast<std::size_t>(std::min(about, 5))].code(coder, gap);
    }
    const int taken = static_cast<int>(std::min(coded, static_cast<std::uint32_t>(kMostScale))) << coarse;
    code.scales[k] = std::max(code.scales[k - 1] - taken, 0);
  }
}

/// Codes the opacity of a Gaussian.
template <class Coder>
void code_opacity(Coder& coder, SplatModels& models, const SplatNode& parent, const SplatCode* sibling,
                  SplatCode& code) {
  const std::size_t leaf = code.leaf ? 1 : 0, beside = sibling ? 1 : 0;
  const int coarse = code.leaf ? 0 : 1;
  int opacity = 0;
  if (models.trained) {
    const int known = sibling ? (sibling->opacity + parent.opacity) / 2 : parent.opacity;
    opacity = static_cast<int>(models.own.opacity[leaf].code(coder, static_cast<std::size_t>(known) / 8,
                                                             static_cast<std::uint32_t>(code.opacity) >> coarse));
  } else {
    opacity = (sibling ? sibling->opacity : parent.opacity) >> coarse;
    TypicalSize& size = models.opacity_size[leaf][beside];
    const int lighter =
        models.former.opacity[leaf][beside].code(coder, size.size(), (code.opacity >> coarse) - opacity);
    size.learn(lighter);
    opacity += lighter;
  }
  code.opacity = std::clamp(opacity << coarse | coarse, 1, kMostOpacity);
}

/// Codes the bits that refine the scales and the opacity of a leaf. Returns zeros for other Gaussians.
template <class Coder>
std::array<int, 4> code_fine(Coder& coder, const SplatCode& code, const Precision& precision) {
  std::array<int, 4> fine{};
  if (!code.leaf) return fine;
  const FineBits bits = fine_bits(code, precision);
  for (std::size_t k = 0; k < 4; ++k)
    if (bits[k] > 0) fine[k] = static_cast<int>(coder.bits(static_cast<std::uint32_t>(code.fine[k]), bits[k]));
  return fine;
}

/// Codes a Gaussian, and returns its shape. With a Writer, `code` is the input; with a Reader, it is the result.
/// `sibling` is the previous Gaussian with the same parent, or null.
template <class Coder>
SplatShape code_splat(Coder& coder, SplatModels& models, const SplatNode& parent, const SplatFrame& frame,
                      const SplatCode* sibling, SplatCode& code, const Precision& precision) {
  code.leaf = coder.bit(models.leaf[sibling ? (sibling->leaf ? 2 : 1) : 0], code.leaf);
  const std::size_t leaf = code.leaf ? 1 : 0;
  code_scale(coder, models, parent, sibling, code);
  code_gaps(coder, models, parent, sibling, code, precision);
  code_opacity(coder, models, parent, sibling, code);
  code.fine = code_fine(coder, code, precision);

  const SplatSteps steps = steps_of(code, precision);
  const int most_turn = precision.tuned() ? kMostTunedTurn : kMostTurn;
  for (std::size_t k = 0; k < 3; ++k) {
    const int size = size_of(0.25 / steps.turn[k]);
    const int turn = models.trained ? models.turn[leaf][k].code_shared(coder, size, code.turn[k])
                                    : models.turn[leaf][k].code(coder, size, code.turn[k]);
    code.turn[k] = std::clamp(turn, -most_turn, most_turn);
  }
  const glm::vec4 rotation = turned(parent.rotation, code.turn, steps.turn);
  const SplatAxes axes = axes_of(rotation);
  const auto spread = place_spread(frame, axes, steps);
  for (std::size_t k = 0; k < 3; ++k) {
    const int size = size_of(spread[k]);
    const int place = models.trained ? models.own.place[code.leaf ? 1 + k : 0].code_shared(coder, size, code.place[k])
                                     : models.former.place[leaf].code(coder, size, code.place[k]);
    code.place[k] = std::clamp(place, -kMostPlace, kMostPlace);
  }
  int louder = 0;  // change of the size by the previous components
  for (std::size_t k = 0; k < 3; ++k) {
    TypicalSize& size = models.color_size[leaf][k];
    const int color = models.trained ? models.color[leaf][k].code_shared(coder, size.size() + louder, code.color[k])
                                     : models.color[leaf][k].code(coder, size.size(), code.color[k]);
    code.color[k] = std::clamp(color, -kMostColor, kMostColor);
    if (models.trained) louder = size.compare(code.color[k]);
    size.learn(code.color[k]);
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
