#include "qnv/codecs/values/labels/label_runs.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/cube_runs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>
#include <utility>

namespace gs::qnv::values {

using displaced::BinaryDecoder;
using displaced::BinaryEncoder;

namespace {

constexpr std::uint32_t kUnknown = 0xffffffff;  // no label
constexpr std::uint32_t kEdge = kCubeEdge + 2;  // of a cube with its neighbours
constexpr std::uint32_t kRow = kEdge, kSlice = kEdge * kEdge;
constexpr std::size_t kRecent = 16, kSearched = 8;  // labels that were coded explicitly
// Sizes of a run. From the first one on, an encoder saves its state before cubes of several labels; from the second one
// on, before all cubes. Above the third one, it restores that state. A run has at most 5 more bytes at its end, and 10
// at its start.
constexpr std::size_t kMixedBytes = 100, kCarefulBytes = 1100, kMostRunBytes = kMaxClusterBytes - 20;

/// Neighbour of a voxel that is coded before it.
struct LabelNeighbour {
  int offset;            // in a LabelWindow
  std::uint32_t weight;  // of its vote
};
constexpr int neighbour(int x, int y, int z) { return x + y * static_cast<int>(kRow) + z * static_cast<int>(kSlice); }
// The first nine are the bits of the context.
constexpr std::array<LabelNeighbour, 13> kNeighbours{{{neighbour(-1, 0, 0), 3},
                                                      {neighbour(0, -1, 0), 3},
                                                      {neighbour(0, 0, -1), 3},
                                                      {neighbour(-1, -1, 0), 2},
                                                      {neighbour(-1, 0, -1), 2},
                                                      {neighbour(0, -1, -1), 2},
                                                      {neighbour(1, -1, 0), 2},
                                                      {neighbour(1, 0, -1), 2},
                                                      {neighbour(0, 1, -1), 2},
                                                      {neighbour(-1, -1, -1), 1},
                                                      {neighbour(1, -1, -1), 1},
                                                      {neighbour(-1, 1, -1), 1},
                                                      {neighbour(1, 1, -1), 1}}};
constexpr std::size_t kContextNeighbours = 9;

/// Labels of a cube, and of the voxels around it as far as its run has them.
struct LabelWindow {
  std::array<std::uint32_t, kEdge * kEdge * kEdge> labels;
  Extent size{};  // of the cube

  [[nodiscard]] static std::size_t at(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return ((z + 1) * kEdge + y + 1) * kEdge + x + 1;
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
  std::array<Estimate, 16> uniform;  // by faces that are known, and that have the expected label
  std::array<Estimate, 4> expected;  // by the latter
  std::array<Estimate, std::size_t{1} << kContextNeighbours> first;
  std::array<Estimate, 16> second;  // by the votes
  std::array<Estimate, kSearched> again;
  std::array<std::uint32_t, kRecent> recent{};
  std::size_t recent_count = 0;

  void remember(std::uint32_t label) {
    std::size_t at = 0;
    while (at < recent_count && recent[at] != label) ++at;
    if (at == recent_count) at = recent_count < kRecent ? recent_count++ : kRecent - 1;
    for (; at > 0; --at) recent[at] = recent[at - 1];
    recent[0] = label;
  }
};

/// Most frequent labels around a voxel, by votes.
struct LabelVotes {
  std::uint32_t first = kUnknown, second = kUnknown;
  std::uint32_t first_votes = 0, second_votes = 0, all = 0;
};

LabelVotes votes_around(const std::uint32_t* here) {
  std::array<std::uint32_t, kNeighbours.size()> labels{}, votes{};
  std::size_t count = 0;
  LabelVotes result;
  for (const LabelNeighbour& near : kNeighbours) {
    const std::uint32_t label = here[near.offset];
    if (label == kUnknown) continue;
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

/// Encodes or decodes the cubes of a run. `Coder` is BinaryEncoder or BinaryDecoder.
template <class Coder>
class LabelCoder {
 public:
  LabelCoder(Coder& coder, LabelModels& models, std::uint32_t count) : coder_(coder), models_(models), count_(count) {}

  /// Encodes the labels of the cube in a window, or sets them.
  void cube(LabelWindow& window) {
    std::uint32_t expected = kUnknown;
    for (const std::size_t beside :
         {LabelWindow::at(0, 0, 0) - 1, LabelWindow::at(0, 0, 0) - kRow, LabelWindow::at(0, 0, 0) - kSlice})
      if (expected == kUnknown) expected = window.labels[beside];
    std::size_t known = 0, same = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bool there = false, equal = true;
      each_beside(window, axis, [&](std::uint32_t label) {
        there = there || label != kUnknown;
        equal = equal && label == expected;
      });
      known += there ? 1 : 0;
      same += there && equal ? 1 : 0;
    }
    std::uint32_t label = window.labels[LabelWindow::at(0, 0, 0)];
    if (code(models_.uniform[4 * known + same], kEncodes && window.is_uniform())) {
      if (expected == kUnknown || !code(models_.expected[same], label == expected))
        label = explicit_label(label, expected, kUnknown);
      else
        label = expected;
      if constexpr (!kEncodes) window.each([&](std::uint32_t& one) { one = label; });
      return;
    }
    if constexpr (kEncodes) {
      // Later voxels are unknown while earlier ones are coded.
      LabelWindow truth = window;
      window.each([](std::uint32_t& one) { one = kUnknown; });
      const std::uint32_t* from = truth.labels.data();
      window.each([&](std::uint32_t& one) { one = voxel(&one, from[&one - window.labels.data()]); });
    } else {
      window.each([](std::uint32_t& one) { one = kUnknown; });
      window.each([&](std::uint32_t& one) { one = voxel(&one, 0); });
    }
  }

 private:
  static constexpr bool kEncodes = std::is_same_v<Coder, BinaryEncoder>;

  // Visits the labels next to the cube, towards lower places on an axis.
  template <class Visit>
  static void each_beside(const LabelWindow& window, std::size_t axis, Visit&& visit) {
    constexpr std::array<std::size_t, 3> kSteps{1, kRow, kSlice};
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
    if (votes.first == kUnknown) return explicit_label(truth, kUnknown, kUnknown);
    std::size_t context = 0;
    for (std::size_t i = 0; i < kContextNeighbours; ++i)
      context |= std::size_t{here[kNeighbours[i].offset] == votes.first} << i;
    Estimate& model = models_.first[context];
    if (model.seen == 0) {
      const std::uint32_t others = votes.all - votes.first_votes;
      model.start(std::max(30000u, 60000u - std::min(2500 * others, 60000u)));
    }
    if (code(model, truth == votes.first)) return votes.first;
    if (count_ == 2) return 1 - std::min(votes.first, 1u);
    if (votes.second != kUnknown && code(models_.second[std::min(votes.second_votes, 15u)], truth == votes.second))
      return votes.second;
    return explicit_label(truth, votes.first, votes.second);
  }

  // Codes a label that is neither of two others.
  std::uint32_t explicit_label(std::uint32_t truth, std::uint32_t first, std::uint32_t second) {
    std::size_t searched = 0;
    for (std::size_t i = 0; i < models_.recent_count && searched < kSearched; ++i) {
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

/// Copies labels between a level and windows. `Grid` is LabelGrid, or const.
template <class Grid>
class WindowFrame {
 public:
  WindowFrame(const CubeOrder& order, Grid& grid) : order_(order), grid_(grid) {}

  /// Moves to a cube of a run with the codes from `first` to `code`. The window gets the labels around it that the run
  /// has before it.
  void move(const Extent& cube, std::uint64_t first, std::uint64_t code, LabelWindow& window) {
    for (std::size_t a = 0; a < 3; ++a) {
      first_[a] = cube[a] * kCubeEdge;
      window.size[a] = std::min(kCubeEdge, grid_.extent[a] - first_[a]);
    }
    window.labels.fill(kUnknown);
    std::array<std::array<std::uint64_t, 3>, 3> parts{};
    std::array<std::array<bool, 3>, 3> there{};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t place = cube[a] + i - 1;  // wraps below 0
        there[a][i] = place < order_.cubes()[a];
        if (there[a][i]) parts[a][i] = order_.part(a, place);
      }
    for (std::uint32_t k = 0; k < 3; ++k)
      for (std::uint32_t j = 0; j < 3; ++j)
        for (std::uint32_t i = 0; i < 3; ++i) {
          if (!there[0][i] || !there[1][j] || !there[2][k]) continue;
          const std::uint64_t of = parts[0][i] | parts[1][j] | parts[2][k];
          if (of >= first && of < code) copy_beside({i, j, k}, window);
        }
  }
  /// Copies the labels of the cube to the window, or back.
  void load(LabelWindow& window) const {
    each_row(window, [](std::uint32_t* in_window, const std::uint32_t* in_grid, std::uint32_t count) {
      std::copy_n(in_grid, count, in_window);
    });
  }
  void store(LabelWindow& window) {
    each_row(window, [](std::uint32_t* in_window, std::uint32_t* in_grid, std::uint32_t count) {
      std::copy_n(in_window, count, in_grid);
    });
  }

 private:
  [[nodiscard]] std::size_t place(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{z} * grid_.extent[1] + y) * grid_.extent[0] + x;
  }
  template <class Visit>
  void each_row(LabelWindow& window, Visit&& visit) const {
    for (std::uint32_t z = 0; z < window.size[2]; ++z)
      for (std::uint32_t y = 0; y < window.size[1]; ++y)
        visit(&window.labels[LabelWindow::at(0, y, z)], &grid_.labels[place(first_[0], first_[1] + y, first_[2] + z)],
              window.size[0]);
  }
  // Copies the labels of a neighbour cube next to the cube: at 0, 1 or 2 on each axis, where 1 is its own place.
  void copy_beside(const Extent& side, LabelWindow& window) const {
    Extent from{}, to{};
    for (std::size_t a = 0; a < 3; ++a) {
      // In the window, the cube itself is from 1 on.
      from[a] = side[a] == 0 ? 0 : side[a] == 1 ? 1 : kCubeEdge + 1;
      to[a] = side[a] == 1 ? 1 + window.size[a] : from[a] + 1;
    }
    for (std::uint32_t z = from[2]; z < to[2]; ++z)
      for (std::uint32_t y = from[1]; y < to[1]; ++y)
        for (std::uint32_t x = from[0]; x < to[0]; ++x)
          window.labels[(z * kEdge + y) * kEdge + x] =
              grid_.labels[place(first_[0] + x - 1, first_[1] + y - 1, first_[2] + z - 1)];
  }

  const CubeOrder& order_;
  Grid& grid_;
  Extent first_{};
};

/// Run that an encoder fills.
struct OpenLabelRun {
  LabelRun run;
  BinaryEncoder encoder;
  LabelModels models;
};

}  // namespace

std::vector<std::byte> pack(const LabelRun& run) {
  std::vector<std::byte> out;
  out.push_back(static_cast<std::byte>(run.level));
  put_number(out, run.first);
  put_number(out, run.count);
  out.insert(out.end(), run.bytes.begin(), run.bytes.end());
  return out;
}

std::optional<LabelRun> parse_label_run(std::span<const std::byte> payload) {
  if (payload.empty() || payload.size() > kMaxClusterBytes) return std::nullopt;
  LabelRun run;
  run.level = std::to_integer<std::uint8_t>(payload.front());
  payload = payload.subspan(1);
  const auto first = take_wide_number(payload), count = take_wide_number(payload);
  if (!first || !count || *count == 0 || *count > kMostRunCubes) return std::nullopt;
  run.first = *first;
  run.count = static_cast<std::uint32_t>(*count);
  run.bytes.assign(payload.begin(), payload.end());
  return run;
}

void encode_label_runs(const LabelGrid& grid, const CubeOrder& order, std::uint32_t count, int level,
                       const std::function<void(LabelRun&&)>& take) {
  WindowFrame<const LabelGrid> frame(order, grid);
  LabelWindow window;
  OpenLabelRun open, before;
  const auto begin = [&](std::uint64_t code) {
    open = {};
    open.run.level = static_cast<std::uint8_t>(level);
    open.run.first = code;
  };
  const auto close = [&] {
    open.run.bytes = open.encoder.finish();
    take(std::move(open.run));
  };
  const auto add = [&](std::uint64_t code, const Extent& cube) {
    frame.move(cube, open.run.first, code, window);
    frame.load(window);
    const std::size_t size = open.encoder.size();
    const bool careful = size >= kCarefulBytes || (size >= kMixedBytes && !window.is_uniform());
    if (careful) before = open;
    LabelCoder<BinaryEncoder>(open.encoder, open.models, count).cube(window);
    open.run.count = static_cast<std::uint32_t>(code - open.run.first + 1);
    return !careful || open.encoder.size() <= kMostRunBytes;
  };
  begin(0);
  for (std::uint64_t code = 0; code < order.codes(); ++code) {
    const Extent cube = order.place(code);
    if (!order.has(cube)) continue;
    if (code - open.run.first >= kMostRunCubes) {
      close();
      begin(code);
    }
    if (add(code, cube)) continue;
    open = before;
    close();
    begin(code);
    (void)add(code, cube);
  }
  close();
}

bool decode_label_run(const LabelRun& run, const CubeOrder& order, std::uint32_t count, LabelGrid& grid,
                      const std::function<void(const Extent& cube)>& decoded) {
  if (run.first >= order.codes() || run.count > order.codes() - run.first || count == 0) return false;
  WindowFrame<LabelGrid> frame(order, grid);
  LabelWindow window;
  LabelModels models;
  BinaryDecoder decoder(run.bytes);
  LabelCoder<BinaryDecoder> coder(decoder, models, count);
  for (std::uint64_t code = run.first; code < run.first + run.count && !decoder.exhausted(); ++code) {
    const Extent cube = order.place(code);
    if (!order.has(cube)) continue;
    frame.move(cube, run.first, code, window);
    coder.cube(window);
    frame.store(window);
    decoded(cube);
  }
  return !decoder.exhausted();
}

}  // namespace gs::qnv::values
