#pragma once

#include "qnv/codecs/shared/lod_view.h"

#include <cstdint>
#include <memory>

namespace gs::qnv {

struct Volume;

/// Finer vectors and values of a volume, where views need them.
class VolumeDetail {
 public:
  VolumeDetail() = default;
  VolumeDetail(const VolumeDetail&) = delete;
  VolumeDetail& operator=(const VolumeDetail&) = delete;
  virtual ~VolumeDetail() = default;

  /// Returns the volume to draw in a view, which stays the same while nothing changes. If LodView::most_decoded is 0,
  /// waits for everything that the view needs and that was received. Otherwise another thread decodes it, and `pending`
  /// becomes true until the volume has it.
  [[nodiscard]] virtual std::shared_ptr<const Volume> cut(const LodView& view, bool& pending) = 0;
  /// Returns the volume of the last cut.
  [[nodiscard]] virtual std::shared_ptr<const Volume> latest() const = 0;
  /// Returns a number that changes when another thread has finished some work for views, or when the next cut would
  /// begin some.
  [[nodiscard]] virtual std::uint64_t revision() const = 0;
};

}  // namespace gs::qnv
