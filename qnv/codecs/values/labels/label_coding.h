#pragma once

#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/lifting.h"
#include "qnv/codecs/values/plane_models.h"
#include "qnv/entropy/binary_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace gs::qnv::values {

// Decisions about the labels of one cube. Encoder and decoder share the code. FORMAT.md, "Labels", defines them.

inline constexpr std::uint32_t kUnknownLabel = 0xffffffff;   // no label
inline constexpr std::uint32_t kWindowEdge = kCubeEdge + 2;  // of a cube with its neighbours
inline constexpr std::uint32_t kWindowRow = kWindowEdge, kWindowSlice = kWindowEdge * kWindowEdge;
inline constexpr std::size_t kRecentLabels = 16, kSearchedLabels = 8;  // labels that were coded explicitly

/// Neighbour of a voxel that is coded before it.
struct LabelNeighbour {
  int offset;            // in a LabelWindow
  std::uint32_t weight;  // of its vote
};
constexpr int label_neighbour(int x, int y, int z) {
  return x + y * static_cast<int>(kWindowRow) + z * static_cast<int>(kWindowSlice);
}
// The first nine are the bits of the context.
inline constexpr std::array<LabelNeighbour, 13> kLabelNeighbours{{{label_neighbour(-1, 0, 0), 3},
                                                                  {label_neighbour(0, -1, 0), 3},
                                                                  {label_neighbour(0, 0, -1), 3},
                                                                  {label_neighbour(-1, -1, 0), 2},
                                                                  {label_neighbour(-1, 0, -1), 2},
                                                                  {label_neighbour(0, -1, -1), 2},
                                                                  {label_neighbour(1, -1, 0), 2},
                                                                  {label_neighbour(1, 0, -1), 2},
                                                                  {label_neighbour(0, 1, -1), 2},
                                                                  {label_neighbour(-1, -1, -1), 1},
                                                                  {label_neighbour(1, -1, -1), 1},
                                                                  {label_neighbour(-1, 1, -1), 1},
                                                                  {label_neighbour(1, 1, -1), 1}}};
inline constexpr std::size_t kContextNeighbours = 9;

/// Labels of a cube, and of the voxels around it as far as its run has them.
struct LabelWindow {
  std::array<std::uint32_t, kWindowEdge * kWindowEdge * kWindowEdge> labels;
  Extent size{};  // of the cube

  [[nodiscard]] static std::size_t at(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return ((z + 1) * kWindowEdge + y + 1) * kWindowEdge + x + 1;
  }
  /// Calls visit(label) for each voxel of the cube, x first.
  template <class Visit>
  void each(Visit&& visit) {
    for (std::uint32_t z = 0; z < size[2]; ++z)
      for (std::uint32_t y = 0; y < size[1]; ++y)
        for (std::uint32_t x = 0; x < size[0]; ++x) visit(labels[at(x, y, z)]);
  }
  [[nodiscard]] bool is_uniform() {
    bool uniform = true;
    each([&, first = labels[at(0, 0, 0)]](std::uint32_t label) { uniform = uniform && label == first; });
    return uniform;
  }
};

/// Estimates of a run, and the labels that it coded explicitly.
struct LabelModels {
  std::array<Estimate, 16> kept;     // by cubes before it that are known, and that are kept
  std::array<Estimate, 16> uniform;  // by faces that are known, and that have the expected label
  std::array<Estimate, 4> expected;  // by the latter
  std::array<Estimate, std::size_t{1} << kContextNeighbours> first;
  std::array<Estimate, 16> second;  // by the votes
  std::array<Estimate, kSearchedLabels> again;
  std::array<std::uint32_t, kRecentLabels> recent{};
  std::size_t recent_count = 0;

  void remember(std::uint32_t label) {
    std::size_t at = 0;
    while (at < recent_count && recent[at] != label) ++at;
    if (at == recent_count) at = recent_count < kRecentLabels ? recent_count++ : kRecentLabels - 1;
    for (; at > 0; --at) recent[at] = recent[at - 1];
    recent[0] = label;
  }
};

/// Most frequent labels around a voxel, by votes.
struct LabelVotes {
  std::uint32_t first = kUnknownLabel, second = kUnknownLabel;
  std::uint32_t first_votes = 0, second_votes = 0, all = 0;
};

inline LabelVotes votes_around(const std::uint32_t* here) {
  std::array<std::uint32_t, kLabelNeighbours.size()> labels{}, votes{};
  std::size_t count = 0;
  LabelVotes result;
  for (const LabelNeighbour& near : kLabelNeighbours) {
    const std::uint32_t label = here[near.offset];
    if (label == kUnknownLabel) continue;
    result.all += near.weight;
    std::size_t i = 0;
    while (i < count && labels[i] != label) ++i;
    if (i == count) labels[count++] = label;
    votes[i] += near.weight;
  }
  for (std::size_t i = 0; i < count; ++i)
    if (votes[i] > result.first_votes) {
      result.second = std::exchange(result.first, labels[i]);
      result.second_votes = std::exchange(result.first_votes, votes[i]);
    } else if (votes[i] > result.second_votes) {
      result.second = labels[i];
      result.second_votes = votes[i];
    }
  return result;
}

/// Encodes or decodes the cubes of a run. `Coder` is displaced::BinaryEncoder or BinaryDecoder.
template <class Coder>
class LabelCoder {
 public:
  LabelCoder(Coder& coder, LabelModels& models, std::uint32_t count) : coder_(coder), models_(models), count_(count) {}

  /// Encodes whether a cube is kept, or returns it. Of the cubes before it along the axes, `known` are in the run, and
  /// `same` are kept.
  bool kept(std::size_t known, std::size_t same, bool truth) { return code(models_.kept[4 * known + same], truth); }

  /// Encodes the labels of the cube in a window, or sets them.
  void cube(LabelWindow& window) {
    std::uint32_t expected = kUnknownLabel;
    for (const std::size_t beside :
         {LabelWindow::at(0, 0, 0) - 1, LabelWindow::at(0, 0, 0) - kWindowRow, LabelWindow::at(0, 0, 0) - kWindowSlice})
      if (expected == kUnknownLabel) expected = window.labels[beside];
    std::size_t known = 0, same = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bool there = false, equal = true;
      each_beside(window, axis, [&](std::uint32_t label) {
        there = there || label != kUnknownLabel;
        equal = equal && label == expected;
      });
      known += there ? 1 : 0;
      same += there && equal ? 1 : 0;
    }
    std::uint32_t label = window.labels[LabelWindow::at(0, 0, 0)];
    if (code(models_.uniform[4 * known + same], kEncodes && window.is_uniform())) {
      if (expected == kUnknownLabel || !code(models_.expected[same], label == expected))
        label = explicit_label(label, expected, kUnknownLabel);
      else
        label = expected;
      if constexpr (!kEncodes) window.each([&](std::uint32_t& one) { one = label; });
      return;
    }
    if constexpr (kEncodes) {
      // Later voxels are unknown while earlier ones are coded.
      LabelWindow truth = window;
      window.each([](std::uint32_t& one) { one = kUnknownLabel; });
      const std::uint32_t* from = truth.labels.data();
      window.each([&](std::uint32_t& one) { one = voxel(&one, from[&one - window.labels.data()]); });
    } else {
      window.each([](std::uint32_t& one) { one = kUnknownLabel; });
      window.each([&](std::uint32_t& one) { one = voxel(&one, 0); });
    }
  }

 private:
  static constexpr bool kEncodes = std::is_same_v<Coder, displaced::BinaryEncoder>;

  // Visits the labels next to the cube, towards lower places on an axis.
  template <class Visit>
  static void each_beside(const LabelWindow& window, std::size_t axis, Visit&& visit) {
    constexpr std::array<std::size_t, 3> kSteps{1, kWindowRow, kWindowSlice};
    const std::size_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    const std::size_t start = LabelWindow::at(0, 0, 0) - kSteps[axis];
    for (std::size_t j = 0; j < window.size[v]; ++j)
      for (std::size_t i = 0; i < window.size[u]; ++i) visit(window.labels[start + i * kSteps[u] + j * kSteps[v]]);
  }

  bool code(Estimate& model, bool bit) {
    if constexpr (kEncodes)
      coder_.put(model.probability(), bit);
    else
      bit = coder_.get(model.probability());
    model.learn(bit);
    return bit;
  }

  std::uint32_t voxel(const std::uint32_t* here, std::uint32_t truth) {
    const LabelVotes votes = votes_around(here);
    if (votes.first == kUnknownLabel) return explicit_label(truth, kUnknownLabel, kUnknownLabel);
    std::size_t context = 0;
    for (std::size_t i = 0; i < kContextNeighbours; ++i)
      context |= std::size_t{here[kLabelNeighbours[i].offset] == votes.first} << i;
    Estimate& model = models_.first[context];
    if (model.seen == 0) {
      const std::uint32_t others = votes.all - votes.first_votes;
      model.start(std::max(30000u, 60000u - std::min(2500 * others, 60000u)));
    }
    if (code(model, truth == votes.first)) return votes.first;
    if (count_ == 2) return 1 - std::min(votes.first, 1u);
    if (votes.second != kUnknownLabel && code(models_.second[std::min(votes.second_votes, 15u)], truth == votes.second))
      return votes.second;
    return explicit_label(truth, votes.first, votes.second);
  }

  // Codes a label that is neither of two others.
  std::uint32_t explicit_label(std::uint32_t truth, std::uint32_t first, std::uint32_t second) {
    std::size_t searched = 0;
    for (std::size_t i = 0; i < models_.recent_count && searched < kSearchedLabels; ++i) {
      const std::uint32_t label = models_.recent[i];
      if (label == first || label == second) continue;
      if (code(models_.again[searched++], truth == label)) {
        models_.remember(label);
        return label;
      }
    }
    const int bits = static_cast<int>(std::bit_width(count_ - 1));
    if constexpr (kEncodes)
      coder_.put_bits(truth, bits);
    else
      truth = std::min(coder_.get_bits(bits), count_ - 1);
    models_.remember(truth);
    return truth;
  }

  Coder& coder_;
  LabelModels& models_;
  const std::uint32_t count_;
};

}  // namespace gs::qnv::values
