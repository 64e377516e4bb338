#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/decode/components_geometry.h"
#include "qnv/codecs/values/decode/values_part.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

/// Decoder of a stream with several numbers per voxel: one decoder for each. It shows one of them, or their magnitude.
class ComponentsDecoder final : public Decoder {
 public:
  ComponentsDecoder(const StreamHeader& header, std::size_t most_vectors)
      : counts_(values::component_counts(header.grid)),
        shown_geometry_(header.grid, std::max<std::size_t>(1, most_vectors / header.grid.components)) {
    for (std::size_t c = 0; c < header.grid.components; ++c)
      parts_.push_back(values::make_values_part(values::header_of_component(header, c),
                                                std::max<std::size_t>(1, most_vectors / header.grid.components)));
  }

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) override {
    const auto split = values::without_component(payload, type == ChunkType::values ? counts_.blocks : counts_.cubes);
    if (!split || split->component >= parts_.size())
      ++refused_;
    else
      parts_[split->component]->add(type, split->payload, missing);
    shown_geometry_.change();
  }
  [[nodiscard]] DecodeCount count() const override {
    DecodeCount all;
    for (const auto& part : parts_) all += part->count();
    all.refused += refused_;
    return all;
  }
  [[nodiscard]] std::size_t vectors() const override {
    std::size_t most = 0;
    for (const auto& part : parts_) most = std::max(most, part->vectors());
    return most;
  }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    return shown_geometry_.geometry(std::move(base), parts_, shown_);
  }
  void show(const ShownComponent& component) override { shown_ = component; }

 private:
  values::ComponentCounts counts_;
  std::vector<std::unique_ptr<values::ValuesPart>> parts_;
  ShownComponent shown_;
  std::size_t refused_ = 0;  // chunks of no component
  mutable values::ComponentsGeometry shown_geometry_;
};

}  // namespace

std::unique_ptr<Decoder> make_components_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<ComponentsDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
