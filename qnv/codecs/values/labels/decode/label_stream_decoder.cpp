#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/values/labels/decode/label_levels.h"
#include "qnv/codecs/values/labels/decode/label_volume.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/codecs/values/values_vectors.h"
#include "qnv/sampling/volume/label_vectors.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

namespace gs::qnv {
namespace {

using values::AddedLabels;

// Maximum number of decoded labels per permitted vector.
constexpr std::uint64_t kLabelsPerVector = 8;

/// Decoder of a stream of labels. Its geometry are the vectors of their surfaces, and the labels.
class LabelStreamDecoder final : public Decoder {
 public:
  LabelStreamDecoder(const StreamHeader& header, std::size_t most_vectors)
      : grid_(header.grid),
        most_vectors_(most_vectors),
        levels_(grid_.dimensions, grid_.palette.size(), finest_level()) {}

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    const auto run = type == ChunkType::labels ? values::parse_label_run(payload) : std::nullopt;
    const AddedLabels added = run ? levels_.add(*run) : AddedLabels::refused;
    if (added == AddedLabels::refused) ++count_.refused;
    if (added == AddedLabels::dropped) count_.full = true;
    if (added == AddedLabels::taken) {
      ++count_.taken;
      shown_.reset();
    }
    in_order_ = in_order_ && (added == AddedLabels::taken || added == AddedLabels::repeated);
  }
  [[nodiscard]] DecodeCount count() const override { return count_; }
  [[nodiscard]] std::size_t vectors() const override {
    const auto extent = values::low_extent(grid_.dimensions, levels_.level());
    const double all = static_cast<double>(values::sample_count(extent));
    return std::min(most_vectors_, static_cast<std::size_t>(std::ceil(kShownFraction * all)));
  }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    if (!shown_) decode(base.description);
    Volume shown = *shown_;
    Description& about = base.description;
    about.spacing = shown.description.spacing;
    about.total = shown.description.total;
    static_cast<GeometryBase&>(shown) = std::move(base);
    return shown;
  }

 private:
  [[nodiscard]] int finest_level() const {
    const std::uint64_t most = std::max<std::uint64_t>(kLabelsPerVector * most_vectors_, 4096);
    int level = 0;
    while (level < 31) {
      const values::Extent part = values::low_extent(grid_.dimensions, level);
      if (std::uint64_t{part[0]} * part[1] * part[2] <= most) break;
      ++level;
    }
    return level;
  }

  void decode(const Description& about) const {
    const int level = levels_.level();
    const auto chunks = static_cast<std::uint32_t>(count_.taken);
    auto made = values::label_values(grid_, about, levels_, level, in_order_ ? std::optional(chunks) : std::nullopt);
    GradientOptions options;
    options.fraction = kShownFraction;
    options.vectors = std::min<std::uint64_t>(most_vectors_, options.vectors);
    options.range = about.value_range;
    auto found = label_vectors(made->source, options);
    if (auto* const volume = std::get_if<Volume>(&found))
      shown_ = std::move(*volume);
    else
      shown_.emplace(GeometryBase());
    shown_->values = std::move(made);
  }

  const ValueGrid grid_;
  const std::size_t most_vectors_;
  values::LabelLevels levels_;
  DecodeCount count_;
  bool in_order_ = true;                 // no chunk was lost or refused so far
  mutable std::optional<Volume> shown_;  // null after a change
};

}  // namespace

std::unique_ptr<Decoder> make_labels_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<LabelStreamDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
