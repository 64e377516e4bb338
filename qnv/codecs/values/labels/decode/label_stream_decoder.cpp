#include "qnv/codecs/shared/decoder.h"
#include "qnv/codecs/values/labels/decode/label_levels.h"
#include "qnv/codecs/values/labels/decode/label_volume.h"

#include <memory>
#include <utility>

namespace gs::qnv {
namespace {

using values::AddedLabels;

/// Decoder of a stream of labels. Its geometry are the vectors of their surfaces, and the labels.
class LabelStreamDecoder final : public Decoder {
 public:
  LabelStreamDecoder(const StreamHeader& header, std::size_t most_vectors)
      : grid_(header.grid),
        most_vectors_(most_vectors),
        levels_(grid_.dimensions, grid_.palette.size(), values::finest_label_level(grid_, most_vectors)) {}

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    const auto run = type == ChunkType::labels ? values::parse_label_run(payload) : std::nullopt;
    const AddedLabels added = run && !run->differs ? levels_.add(*run) : AddedLabels::refused;
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
    return values::most_label_vectors(grid_, levels_.level(), most_vectors_);
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
  void decode(const Description& about) const {
    const int level = levels_.level();
    const auto chunks = static_cast<std::uint32_t>(count_.taken);
    auto made = values::label_values(grid_, about, levels_, level, in_order_ ? std::optional(chunks) : std::nullopt);
    shown_ = values::label_surface(std::move(made), {about, {}}, most_vectors_);
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
