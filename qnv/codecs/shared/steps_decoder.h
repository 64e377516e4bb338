#pragma once

#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace gs::qnv {

/// Decoder of a time series. Its geometry is one step, which has the series. `Steps` keeps the received chunks; views
/// share it, and it has its own lock.
template <class Steps>
class StepsDecoder final : public Decoder {
 public:
  StepsDecoder(const StreamHeader& header, std::size_t most_vectors)
      : steps_(std::make_shared<Steps>(header, most_vectors)) {}

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    steps_->add(type, payload);
  }
  void leave_order() override { steps_->leave_order(); }
  [[nodiscard]] DecodeCount count() const override { return steps_->count(); }
  [[nodiscard]] std::size_t vectors() const override { return steps_->vectors(); }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    return steps_->geometry(std::move(base), shown_);
  }
  void show(const ShownComponent& shown) override { shown_ = shown; }

 private:
  std::shared_ptr<Steps> steps_;
  ShownComponent shown_;
};

}  // namespace gs::qnv
