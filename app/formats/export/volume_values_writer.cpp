#include "app/formats/export/volume_values_writer.h"

#include "base/nth_type.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

namespace gs::app {
namespace {

using qnv::VoxelType;

bool is_float(VoxelType type) { return type == VoxelType::f32 || type == VoxelType::f64; }

template <class Take>
void with_type(VoxelType type, Take&& take) {
  with_nth_type<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, float, double>(
      static_cast<std::size_t>(type), take);
}

// Type with the other sign, and the number that maps the old type to it.
struct Moved {
  VoxelType type;
  double offset = 0;
};
Moved moved(VoxelType type) {
  if (type == VoxelType::u16) return {VoxelType::i16, 32768};
  if (type == VoxelType::u32) return {VoxelType::i32, 2147483648.0};
  if (type == VoxelType::i8) return {VoxelType::u8, -128};
  return {type, 0};
}

/// Writes numbers of one type.
class NumberWriter {
 public:
  NumberWriter(VoxelType type, bool big_endian, double missing)
      : type_(type), swap_(big_endian != (std::endian::native == std::endian::big)), missing_(missing) {}

  void operator()(std::span<const double> numbers, std::byte* to) const {
    with_type(type_, [&]<class T>(T) {
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const double number = numbers[i] == numbers[i] ? numbers[i] : missing_;
        T written;
        if constexpr (std::is_floating_point_v<T>)
          written = static_cast<T>(number);
        else
          written = static_cast<T>(std::clamp(std::round(number), static_cast<double>(std::numeric_limits<T>::min()),
                                              static_cast<double>(std::numeric_limits<T>::max())));
        std::memcpy(to + i * sizeof(T), &written, sizeof(T));
        if (swap_) std::reverse(to + i * sizeof(T), to + (i + 1) * sizeof(T));
      }
    });
  }

 private:
  VoxelType type_;
  bool swap_;
  double missing_;
};

}  // namespace

std::variant<WrittenVoxels, std::string> WrittenVoxels::of(const qnv::Geometry& geometry, const VoxelForm& form) {
  const auto* volume = geometry.as<qnv::Volume>();
  const qnv::VolumeValues* values = volume ? volume->values.get() : nullptr;
  if (!values) return std::string("the input has no values of voxels; expected a volume, or a stream of its values");
  if (values->level > 0)
    return std::string("only coarse values could be decoded; expected the whole stream, or a higher memory limit");
  const qnv::VolumeLayout& from = values->source.layout;
  if (const auto problem = qnv::check(from)) return problem->message;
  WrittenVoxels written;
  if (values->steps.empty()) {
    if (auto problem = written.add(*values)) return std::move(*problem);
  } else {
    written.times_ = values->times;
    for (const auto& step : values->steps)
      if (auto problem = written.add(*step)) return std::move(*problem);
  }
  written.components_ = written.parts_.size() / std::max<std::size_t>(written.times_.size(), 1);
  values = written.parts_.front();
  written.form_ = form;
  written.layout_ = from;
  written.layout_.colors = from.colors && written.components_ > 1;
  written.form_.planes = form.planes && !written.layout_.colors;
  qnv::VolumeLayout& to = written.layout_;
  to.type = values->stored;
  to.slope = values->slope;
  to.intercept = values->intercept;
  to.missing = values->missing;
  to.big_endian = form.big_endian;
  const bool scales = to.slope != 1 || to.intercept != 0;
  if (scales && !form.scaled) {
    to.type = VoxelType::f32;
    to.slope = 1;
    to.intercept = 0;
    to.missing.reset();
  }
  if (form.fits_types) {
    const Moved other = moved(to.type);
    to.type = other.type;
    written.offset_ = other.offset;
    to.intercept += to.slope * written.offset_;
    if (to.missing) *to.missing -= written.offset_;
  }
  return written;
}

std::uint64_t WrittenVoxels::bytes() const {
  return qnv::voxel_count(layout_) * qnv::size_of(layout_.type) * parts_.size();
}

std::optional<std::string> WrittenVoxels::add(const qnv::VolumeValues& values) {
  const qnv::VolumeLayout& first = (parts_.empty() ? values : *parts_.front()).source.layout;
  const std::size_t before = parts_.size();
  for (const auto& component : values.components) parts_.push_back(component.get());
  if (values.components.empty()) parts_.push_back(&values);
  for (const qnv::VolumeValues* part : std::span(parts_).subspan(before))
    if (part->source.layout.dimensions != first.dimensions || part->stored != parts_.front()->stored)
      return std::string("the components of the voxels differ; expected one of them by --component");
  return std::nullopt;
}

std::optional<std::string> WrittenVoxels::convert(std::size_t part, std::uint32_t z, std::vector<std::byte>& to) const {
  const qnv::VolumeValues& values = *parts_[part];
  const qnv::VolumeLayout& from = values.source.layout;
  const double missing =
      is_float(layout_.type) ? std::numeric_limits<double>::quiet_NaN() : layout_.missing.value_or(0);
  const double slope = layout_.slope, intercept = layout_.intercept - layout_.slope * offset_;
  const bool same = from.slope == slope && from.intercept == intercept;
  const std::size_t slice = qnv::slice_voxels(from);
  std::vector<std::byte> stored(slice * qnv::size_of(from.type));
  std::vector<double> numbers(slice);
  if (!values.source.read(z, stored)) return "slice " + std::to_string(z) + " cannot be read";
  qnv::stored_numbers(from, stored, numbers);
  for (double& number : numbers) {
    if (!same) number = (number * from.slope + from.intercept - intercept) / slope;
    number -= offset_;
  }
  to.resize(slice * qnv::size_of(layout_.type));
  NumberWriter(layout_.type, form_.big_endian, missing)(numbers, to.data());
  return std::nullopt;
}

std::optional<std::string> WrittenVoxels::write_joined(std::size_t step, std::uint32_t z, const TakeBytes& take) const {
  const std::size_t size = qnv::size_of(layout_.type);
  std::vector<std::byte> one, all;
  for (std::size_t c = 0; c < components_; ++c) {
    if (auto problem = convert(step * components_ + c, z, one)) return problem;
    all.resize(one.size() * components_);
    for (std::size_t i = 0; i < one.size(); i += size)
      std::copy_n(one.data() + i, size, all.data() + i * components_ + c * size);
  }
  return take(all) ? std::nullopt : std::optional<std::string>(std::string());
}

std::optional<std::string> WrittenVoxels::write(const TakeBytes& take) const {
  const std::size_t steps = parts_.size() / components_, planes = form_.planes ? components_ : 1;
  for (std::size_t plane = 0; plane < planes; ++plane)
    for (std::size_t step = 0; step < steps; ++step)
      for (std::uint32_t z = 0; z < layout_.dimensions[2]; ++z) {
        if (!form_.planes) {
          if (auto problem = write_joined(step, z, take)) return problem;
          continue;
        }
        std::vector<std::byte> one;
        if (auto problem = convert(step * components_ + plane, z, one)) return problem;
        if (!take(one)) return std::string();
      }
  return std::nullopt;
}

}  // namespace gs::app
