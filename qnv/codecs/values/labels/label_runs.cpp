#include "qnv/codecs/values/labels/label_runs.h"

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/labels/label_coding.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gs::qnv::values {

using displaced::BinaryDecoder;
using displaced::BinaryEncoder;

namespace {

constexpr std::uint8_t kMayKeep = 128;  // bit of a chunk's level
// Sizes of a run. From the first one on, an encoder saves its state before cubes of several labels; from the second one
// on, before all cubes. Above the third one, it restores that state. A run has at most 5 more bytes at its end, and 10
// at its start.
constexpr std::size_t kMixedBytes = 100, kCarefulBytes = 1100, kMostRunBytes = kMaxClusterBytes - 20;

/// Flags of the cubes of a run that are kept, by code.
class KeptCubes {
 public:
  void start(std::uint64_t first) {
    first_ = first;
    kept_.clear();
  }
  /// Adds the cube of a code, which must be higher than those before. Returns the number of cubes before.
  std::size_t add(std::uint64_t code, bool kept) {
    const std::size_t before = kept_.size();
    kept_.resize(static_cast<std::size_t>(code - first_), false);
    kept_.push_back(kept);
    return before;
  }
  /// Drops the cubes after the first ones.
  void cut(std::size_t count) { kept_.resize(count); }
  /// Reports whether a cube of the run is kept.
  [[nodiscard]] bool has(std::uint64_t code) const {
    return code - first_ < kept_.size() && kept_[static_cast<std::size_t>(code - first_)];
  }

 private:
  std::uint64_t first_ = 0;
  std::vector<bool> kept_;
};

/// Cubes of a run that is decoded. A cube with one label takes 8 bytes.
class RunCubes final : public LabelCubes {
 public:
  RunCubes(const LabelRun& run, const CubeOrder& order, const Extent& extent)
      : order_(order), extent_(extent), first_(run.first) {}

  [[nodiscard]] const Extent& extent() const override { return extent_; }
  /// `cube` must have been added.
  [[nodiscard]] CubeLabels cube(const Extent& cube) override {
    const Cube& one = cubes_[static_cast<std::size_t>(order_.code(cube) - first_)];
    if (one.mixed) return {&mixed_[std::size_t{one.label} * kCubeSize], kCubeEdge, kCubeEdge * kCubeEdge};
    equal_.fill(one.label);
    return {equal_.data(), 0, 0};
  }
  /// Adds the cube of a code, which must be higher than those before.
  void add(std::uint64_t code, LabelWindow& window) {
    cubes_.resize(static_cast<std::size_t>(code - first_));
    if (window.is_uniform()) {
      cubes_.push_back({window.labels[LabelWindow::at(0, 0, 0)], false});
      return;
    }
    cubes_.push_back({static_cast<std::uint32_t>(mixed_.size() / kCubeSize), true});
    const std::size_t at = mixed_.size();
    mixed_.resize(at + kCubeSize);
    for (std::uint32_t z = 0; z < window.size[2]; ++z)
      for (std::uint32_t y = 0; y < window.size[1]; ++y)
        std::copy_n(&window.labels[LabelWindow::at(0, y, z)], window.size[0],
                    &mixed_[at + (z * kCubeEdge + y) * kCubeEdge]);
  }

 private:
  struct Cube {
    std::uint32_t label = 0;  // or the number of the cube in mixed_
    bool mixed = false;
  };
  const CubeOrder& order_;
  const Extent extent_;
  const std::uint64_t first_;
  std::vector<Cube> cubes_;  // by code
  std::vector<std::uint32_t> mixed_;
  std::array<std::uint32_t, kCubeEdge> equal_{};
};

/// Copies labels of a level to windows.
class WindowFrame {
 public:
  WindowFrame(const CubeOrder& order, LabelCubes& level) : order_(order), level_(level) {}

  /// Cubes that are kept; they count as unknown.
  [[nodiscard]] KeptCubes& kept() { return kept_; }
  /// Calls visit(known, same) with the cubes before a cube along the axes: those in the run, and those that are kept.
  template <class Visit>
  auto with_context(const Extent& cube, std::uint64_t first, std::uint64_t code, Visit&& visit) const {
    std::size_t known = 0, same = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (cube[a] == 0) continue;
      Extent beside = cube;
      --beside[a];
      const std::uint64_t of = order_.code(beside);
      if (of < first || of >= code) continue;
      ++known;
      same += kept_.has(of) ? 1 : 0;
    }
    return visit(known, same);
  }

  /// Moves to a cube of a run with the codes from `first` to `code`. The window gets the labels around it that the run
  /// has before it.
  void move(const Extent& cube, std::uint64_t first, std::uint64_t code, LabelWindow& window) {
    for (std::size_t a = 0; a < 3; ++a) window.size[a] = std::min(kCubeEdge, level_.extent()[a] - cube[a] * kCubeEdge);
    window.labels.fill(kUnknownLabel);
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
          if (of >= first && of < code && !kept_.has(of))
            copy_beside({i, j, k}, level_.cube({cube[0] + i - 1, cube[1] + j - 1, cube[2] + k - 1}), window);
        }
  }
  /// Copies the labels of the cube to the window.
  static void load(const CubeLabels& from, LabelWindow& window) {
    for (std::uint32_t z = 0; z < window.size[2]; ++z)
      for (std::uint32_t y = 0; y < window.size[1]; ++y)
        std::copy_n(from.labels + z * from.slice + y * from.row, window.size[0],
                    &window.labels[LabelWindow::at(0, y, z)]);
  }

 private:
  // Copies the labels of a neighbour cube next to the cube: at 0, 1 or 2 on each axis, where 1 is its own place.
  static void copy_beside(const Extent& side, const CubeLabels& from, LabelWindow& window) {
    Extent source{}, target{}, size{};
    for (std::size_t a = 0; a < 3; ++a) {
      // In the window, the cube itself is from 1 on.
      source[a] = side[a] == 0 ? kCubeEdge - 1 : 0;
      target[a] = side[a] == 0 ? 0 : side[a] == 1 ? 1 : kCubeEdge + 1;
      size[a] = side[a] == 1 ? window.size[a] : 1;
    }
    for (std::uint32_t z = 0; z < size[2]; ++z)
      for (std::uint32_t y = 0; y < size[1]; ++y)
        std::copy_n(from.labels + (source[2] + z) * from.slice + (source[1] + y) * from.row + source[0], size[0],
                    &window.labels[((target[2] + z) * kWindowEdge + target[1] + y) * kWindowEdge + target[0]]);
  }

  const CubeOrder& order_;
  LabelCubes& level_;
  KeptCubes kept_;
};

/// Reports whether two cubes have the same labels.
bool equal_cubes(const CubeLabels& a, const CubeLabels& b, const Extent& size) {
  for (std::uint32_t z = 0; z < size[2]; ++z)
    for (std::uint32_t y = 0; y < size[1]; ++y)
      if (!std::equal(a.labels + z * a.slice + y * a.row, a.labels + z * a.slice + y * a.row + size[0],
                      b.labels + z * b.slice + y * b.row))
        return false;
  return true;
}

/// Run that an encoder fills.
struct OpenLabelRun {
  LabelRun run;
  BinaryEncoder encoder;
  LabelModels models;
};

}  // namespace

std::vector<std::byte> pack(const LabelRun& run) {
  std::vector<std::byte> out;
  out.push_back(static_cast<std::byte>(run.level | (run.differs ? kMayKeep : 0)));
  put_number(out, run.first);
  put_number(out, run.count);
  out.insert(out.end(), run.bytes.begin(), run.bytes.end());
  return out;
}

std::optional<LabelRun> parse_label_run(std::span<const std::byte> payload) {
  if (payload.empty() || payload.size() > kMaxClusterBytes) return std::nullopt;
  LabelRun run;
  run.level = std::to_integer<std::uint8_t>(payload.front()) & static_cast<std::uint8_t>(~kMayKeep);
  run.differs = (std::to_integer<std::uint8_t>(payload.front()) & kMayKeep) != 0;
  payload = payload.subspan(1);
  const auto first = take_wide_number(payload), count = take_wide_number(payload);
  if (!first || !count || *count == 0 || *count > kMostRunCubes) return std::nullopt;
  run.first = *first;
  run.count = static_cast<std::uint32_t>(*count);
  run.bytes.assign(payload.begin(), payload.end());
  return run;
}

std::uint64_t take_step(LabelRun& run, std::uint64_t codes) {
  const std::uint64_t step = run.first / codes;
  run.first %= codes;
  return step;
}

void encode_label_runs(LabelCubes& level_labels, const CubeOrder& order, std::uint64_t segment, std::uint32_t count,
                       int level, const std::function<bool(LabelRun&&)>& take, LabelCubes* before) {
  WindowFrame frame(order, level_labels);
  LabelWindow window;
  OpenLabelRun open, saved;
  bool any = false;  // a cube of the run is not kept
  const auto begin = [&](std::uint64_t code) {
    open = {};
    open.run.level = static_cast<std::uint8_t>(level);
    open.run.first = code;
    open.run.differs = before != nullptr;
    frame.kept().start(code);
    any = false;
  };
  const auto close = [&] {
    if (!any) return true;
    open.run.bytes = open.encoder.finish();
    return take(std::move(open.run));
  };
  const auto is_kept = [&](const Extent& cube) {
    if (!before) return false;
    Extent size{};
    for (std::size_t a = 0; a < 3; ++a) size[a] = std::min(kCubeEdge, level_labels.extent()[a] - cube[a] * kCubeEdge);
    return equal_cubes(level_labels.cube(cube), before->cube(cube), size);
  };
  const auto add = [&](std::uint64_t code, const Extent& cube, bool kept) {
    if (!kept) {
      frame.move(cube, open.run.first, code, window);
      WindowFrame::load(level_labels.cube(cube), window);
    }
    const std::size_t size = open.encoder.size();
    const bool careful = size >= kCarefulBytes || (size >= kMixedBytes && !kept && !window.is_uniform());
    if (careful) saved = open;
    LabelCoder<BinaryEncoder> coder(open.encoder, open.models, count);
    if (before) {
      frame.with_context(cube, open.run.first, code,
                         [&](std::size_t known, std::size_t same) { return coder.kept(known, same, kept); });
      const std::size_t cubes = frame.kept().add(code, kept);
      if (!kept) coder.cube(window);
      if (careful && open.encoder.size() > kMostRunBytes) frame.kept().cut(cubes);
    } else {
      coder.cube(window);
    }
    open.run.count = static_cast<std::uint32_t>(code - open.run.first + 1);
    const bool fits = !careful || open.encoder.size() <= kMostRunBytes;
    any = any || (fits && !kept);
    return fits;
  };
  const std::uint64_t first = segment * kSegmentCodes, end = std::min(order.codes(), first + kSegmentCodes);
  begin(first);
  for (std::uint64_t code = first; code < end; ++code) {
    const Extent cube = order.place(code);
    if (!order.has(cube)) continue;
    const bool kept = is_kept(cube);
    // A run begins with a cube that is not kept.
    if (kept && !any) continue;
    if (!any && before) begin(code);
    if (code - open.run.first >= kMostRunCubes) {
      if (!close()) return;
      begin(code);
      if (kept) continue;
    }
    if (add(code, cube, kept)) continue;
    open = saved;
    if (!close()) return;
    begin(code);
    if (!kept) (void)add(code, cube, kept);
  }
  (void)close();
}

bool decode_label_run(const LabelRun& run, const CubeOrder& order, const Extent& extent, std::uint32_t count,
                      const std::function<void(const Extent& cube, const CubeLabels& labels)>& decoded) {
  if (run.first >= order.codes() || run.count > order.codes() - run.first || count == 0) return false;
  RunCubes cubes(run, order, extent);
  WindowFrame frame(order, cubes);
  LabelWindow window;
  LabelModels models;
  frame.kept().start(run.first);
  BinaryDecoder decoder(run.bytes);
  LabelCoder<BinaryDecoder> coder(decoder, models, count);
  for (std::uint64_t code = run.first; code < run.first + run.count && !decoder.exhausted(); ++code) {
    const Extent cube = order.place(code);
    if (!order.has(cube)) continue;
    if (run.differs) {
      const bool kept = frame.with_context(
          cube, run.first, code, [&](std::size_t known, std::size_t same) { return coder.kept(known, same, false); });
      frame.kept().add(code, kept);
      if (kept) continue;
    }
    frame.move(cube, run.first, code, window);
    coder.cube(window);
    cubes.add(code, window);
    decoded(cube, cubes.cube(cube));
  }
  return !decoder.exhausted();
}

}  // namespace gs::qnv::values
