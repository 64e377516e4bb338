#pragma once

#include "app/formats/datasets/arrays/box_pieces.h"
#include "app/formats/datasets/arrays/grid_volume.h"
#include "app/formats/datasets/arrays/slab_reader.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::app {

/// Reads one component of one step of a volume. The indices of the other axes are constant.
class GridReader {
 public:
  GridReader(std::shared_ptr<SlabReader> slabs, std::shared_ptr<const GridSpec> spec, const ArrayInfo& array)
      : slabs_(std::move(slabs)), spec_(std::move(spec)), type_(array.type), parts_(array.parts) {
    slice_.first.assign(array.shape.size(), 0);
    slice_.count.assign(array.shape.size(), 1);
    for (std::size_t i = 0; i < spec_->axes.size(); ++i) {
      const AxisRole role = spec_->axes[i].role;
      if (role == AxisRole::x) x_ = i;
      if (role == AxisRole::y) y_ = i;
      if (role == AxisRole::z) slice_.along = i;
      if (role == AxisRole::component) component_axis_ = i;
      if (role == AxisRole::x || role == AxisRole::y || role == AxisRole::component) slice_.count[i] = array.shape[i];
    }
    size_ = {x_ ? array.shape[*x_] : 1, y_ ? array.shape[*y_] : 1, slice_.along ? array.shape[*slice_.along] : 1};
  }

  void choose_array(std::size_t array) { slice_.array = array; }
  void choose_index(std::size_t axis, std::uint64_t index) { slice_.first[axis] = index; }
  /// Chooses a component: an element along the axis of components, or a part of each element.
  void choose_component(std::uint64_t component) { component_ = component; }
  [[nodiscard]] const std::array<std::uint64_t, 3>& size() const { return size_; }
  [[nodiscard]] NumberType type() const { return type_; }

  /// Reads the stored numbers of a slice, x first. `to` has their size.
  bool read_stored(std::uint64_t z, std::span<std::byte> to);

  /// Reads the stored numbers of a box. `to` has their size.
  bool read_stored(const qnv::VoxelBox& box, std::span<std::byte> to);
  /// Returns the edges of the chunks along x, y and z; 0 if there are none.
  [[nodiscard]] std::array<std::uint32_t, 3> chunk() const;

  /// Reads the stored numbers of a slice as doubles; missing ones are NaN.
  bool read_numbers(std::uint64_t z, std::vector<double>& to) {
    raw_.resize(size_of(type_) * static_cast<std::size_t>(size_[0] * size_[1]));
    if (!read_stored(z, raw_)) return false;
    take_numbers(to);
    return true;
  }
  /// Reads the stored numbers of a box as doubles; missing ones are NaN.
  bool read_numbers(const qnv::VoxelBox& box, std::vector<double>& to) {
    raw_.resize(size_of(type_) * static_cast<std::size_t>(qnv::voxel_count(box)));
    if (!read_stored(box, raw_)) return false;
    take_numbers(to);
    return true;
  }
  /// Reads the values of a slice, with slope and intercept.
  bool read_values(std::uint64_t z, std::vector<double>& to) { return read_numbers(z, to) && scale(to); }
  bool read_values(const qnv::VoxelBox& box, std::vector<double>& to) { return read_numbers(box, to) && scale(to); }

 private:
  bool scale(std::vector<double>& numbers) const {
    for (double& number : numbers) number = number * spec_->slope + spec_->intercept;
    return true;
  }
  void take_numbers(std::vector<double>& to) const;

  std::shared_ptr<SlabReader> slabs_;
  std::shared_ptr<const GridSpec> spec_;
  NumberType type_;
  std::uint32_t parts_;
  ArraySlice slice_;
  std::optional<std::size_t> x_, y_, component_axis_;
  std::uint64_t component_ = 0;
  std::array<std::uint64_t, 3> size_{1, 1, 1};
  std::vector<std::byte> raw_;
};

}  // namespace gs::app
