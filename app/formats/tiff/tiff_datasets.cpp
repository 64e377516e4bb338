#include "app/formats/tiff/tiff_datasets.h"

#include "app/formats/datasets/arrays/dataset_module.h"
#include "app/formats/datasets/arrays/grid_volume.h"
#include "app/formats/tiff/tiff_layout.h"
#include "base/text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace gs::app {
namespace {

/// Images of a file as arrays of time, slice, channel, row and column. The file itself has pages only.
class TiffPlanes final : public ArrayFile {
 public:
  TiffPlanes(std::shared_ptr<ArrayFile> pages, std::vector<TiffImage> images)
      : pages_(std::move(pages)), images_(std::move(images)) {
    for (const TiffImage& image : images_) {
      ArrayInfo info = pages_->arrays()[image.array];
      info.path = images_.size() == 1 ? "/image" : "/image-" + std::to_string(arrays_.size() + 1);
      const std::uint64_t height = info.shape[1], width = info.shape[2];
      info.shape.clear();
      info.dimensions.clear();
      const auto add = [&](const char* name, std::uint64_t size) {
        info.dimensions.emplace_back(name);
        info.shape.push_back(size);
      };
      if (image.times > 1) add("time", image.times);
      add("z", image.slices);
      if (image.channels > 1) add("channel", image.channels);
      add("y", height);
      add("x", width);
      info.chunk.assign(info.shape.size(), 1);
      info.chunk[info.chunk.size() - 2] = height;
      info.chunk[info.chunk.size() - 1] = width;
      const bool narrows = colors(image.array) && info.type == NumberType::u16;
      narrows_.push_back(narrows);
      if (narrows) info.type = NumberType::u8;
      info.type_name = type_name(info);
      arrays_.push_back(std::move(info));
    }
  }

  [[nodiscard]] const std::vector<ArrayInfo>& arrays() const override { return arrays_; }
  [[nodiscard]] const std::vector<std::string>& groups() const override { return groups_; }
  [[nodiscard]] std::vector<ArrayAttribute> attributes(const std::string& path) override {
    for (std::size_t i = 0; i < arrays_.size(); ++i)
      if (arrays_[i].path == path) return pages_->attributes(pages_->arrays()[images_[i].array].path);
    return {};
  }

  [[nodiscard]] std::string read(std::size_t array, std::span<const std::uint64_t> first,
                                 std::span<const std::uint64_t> count, std::span<std::byte> to) override {
    if (array >= arrays_.size() || first.size() != arrays_[array].shape.size() || count.size() != first.size())
      return "no such array";
    const TiffImage& image = images_[array];
    const ArrayInfo& info = arrays_[array];
    for (std::size_t i = 0; i < first.size(); ++i)
      if (first[i] > info.shape[i] || count[i] > info.shape[i] - first[i]) return "a box outside of the array";
    std::size_t axis = 0;
    const auto range = [&](bool there) {
      const std::array<std::uint64_t, 2> all{there ? first[axis] : 0, there ? count[axis] : 1};
      axis += there ? 1 : 0;
      return all;
    };
    const auto times = range(image.times > 1), slices = range(true), channels = range(image.channels > 1);
    const std::array<std::uint64_t, 2> place{first[axis], first[axis + 1]}, size{count[axis], count[axis + 1]};
    const std::size_t bytes = size[0] * size[1] * info.parts * size_of(info.type);
    std::size_t at = 0;
    for (std::uint64_t time = times[0]; time < times[0] + times[1]; ++time)
      for (std::uint64_t slice = slices[0]; slice < slices[0] + slices[1]; ++slice)
        for (std::uint64_t channel = channels[0]; channel < channels[0] + channels[1]; ++channel) {
          if (to.size() - at < bytes) return "a buffer of another size than the box";
          const std::span<std::byte> out = to.subspan(at, bytes);
          at += bytes;
          const std::uint32_t page = image.page(time, slice, channel);
          if (page == TiffImage::kNoPage) {
            std::ranges::fill(out, std::byte{0});
            continue;
          }
          const std::array<std::uint64_t, 3> from{page, place[0], place[1]}, box{1, size[0], size[1]};
          if (std::string problem = read_plane(array, from, box, out); !problem.empty()) return problem;
        }
    return {};
  }

  [[nodiscard]] bool colors(std::size_t pages) {
    for (const ArrayAttribute& attribute : pages_->attributes(pages_->arrays()[pages].path))
      if (attribute.name == "colors") return !attribute.numbers.empty() && attribute.numbers[0] != 0;
    return false;
  }
  [[nodiscard]] const TiffImage& image(std::size_t array) const { return images_[array]; }

 private:
  static std::string type_name(const ArrayInfo& info) {
    static constexpr std::array<const char*, 11> kNames{"u8",  "i8",  "u16", "i16", "u32", "i32",
                                                        "f32", "f64", "u64", "i64", "none"};
    std::string text = kNames[static_cast<std::size_t>(info.type)];
    if (info.parts > 1) text = std::to_string(info.parts) + " x " + text;
    return text;
  }

  std::string read_plane(std::size_t array, std::span<const std::uint64_t> first, std::span<const std::uint64_t> count,
                         std::span<std::byte> to) {
    if (!narrows_[array]) return pages_->read(images_[array].array, first, count, to);
    std::vector<std::byte> wide(to.size() * 2);  // colours of 16 bits
    if (std::string problem = pages_->read(images_[array].array, first, count, wide); !problem.empty()) return problem;
    for (std::size_t i = 0; i < to.size(); ++i) {
      std::uint16_t value = 0;
      std::memcpy(&value, wide.data() + i * 2, sizeof(value));
      to[i] = static_cast<std::byte>(value >> 8);
    }
    return {};
  }

  std::shared_ptr<ArrayFile> pages_;
  std::vector<TiffImage> images_;
  std::vector<ArrayInfo> arrays_;
  std::vector<std::string> groups_;
  std::vector<bool> narrows_;
};

class TiffDatasets final : public DatasetFile {
 public:
  TiffDatasets(std::shared_ptr<TiffPlanes> planes, const VolumeFile& file, std::size_t missing)
      : planes_(planes), tree_(planes, file.content, file.budget), missing_(missing) {
    for (std::size_t i = 0; i < planes_->arrays().size(); ++i) {
      const ArrayInfo& array = planes_->arrays()[i];
      const TiffImage& image = planes_->image(i);
      DatasetEntry entry;
      entry.path = array.path;
      entry.shape = array.shape;
      entry.type = array.type_name;
      for (const std::string& name : array.dimensions) entry.axes += (entry.axes.empty() ? "" : ", ") + name;
      entry.form = DatasetForm::volume;
      if (!image.described && image.slices > 1) entry.note = "pages as slices";
      if (missing_ > 0) entry.note = std::to_string(missing_) + " planes are in other files";
      entry.rank = 1;
      for (const std::uint64_t size : array.shape) entry.rank *= static_cast<double>(size);
      entries_.push_back(std::move(entry));
    }
  }

  const std::vector<DatasetEntry>& entries() const override { return entries_; }

  VolumeResult volume(std::size_t number, const VoxelComponent& choice) override {
    const ArrayInfo& array = planes_->arrays()[number];
    const TiffImage& image = planes_->image(number);
    GridSpec spec;
    spec.arrays = {number};
    spec.path = array.path;
    for (const std::string& name : array.dimensions) spec.axes.push_back(axis_of(image, name));
    spec.colors = planes_->colors(image.array);
    // Instruments do not measure integers of 32 bits, but programs write labels with them.
    const bool integer = array.type >= NumberType::u8 && array.type <= NumberType::i64 &&
                         array.type != NumberType::f32 && array.type != NumberType::f64;
    spec.labels = integer && size_of(array.type) >= 4 && array.parts == 1;
    if (const auto nodata = tree_.number(array.path, "nodata")) spec.missing.push_back(*nodata);
    if (!image.unit.empty()) spec.metadata.emplace_back("space units", image.unit);
    if (!image.time_unit.empty()) spec.metadata.emplace_back("time unit", image.time_unit);
    if (!image.channel_names.empty() && image.channels > 1) {
      std::string names;
      for (const std::string& name : image.channel_names) names += (names.empty() ? "" : ", ") + name;
      spec.metadata.emplace_back("channels", names);
    }
    // A picture faces the viewer; the first slice of a stack lies on top.
    if (image.slices == 1) {
      spec.metadata.emplace_back("up", "-y");
      spec.metadata.emplace_back("front", "-z");
    }
    return open_grid(tree_, std::move(spec), choice);
  }

  void mesh(std::size_t, const VoxelComponent&, MeshBuilder&) override {}

 private:
  static GridAxis axis_of(const TiffImage& image, std::string_view name) {
    GridAxis axis;
    axis.name = name;
    if (name == "time") {
      axis.role = AxisRole::time;
      for (std::uint64_t i = 0; i < image.times; ++i)
        axis.positions.push_back(image.time_step * static_cast<double>(i));
      axis.step = image.time_step;
    } else if (name == "z") {
      axis.role = AxisRole::z;
      axis.step = image.spacing_z;
    } else if (name == "channel") {
      axis.role = AxisRole::channel;
    } else {
      axis.role = name == "y" ? AxisRole::y : AxisRole::x;
      axis.step = name == "y" ? image.spacing_y : image.spacing_x;
    }
    return axis;
  }

  std::shared_ptr<TiffPlanes> planes_;
  DatasetTree tree_;
  std::size_t missing_;
  std::vector<DatasetEntry> entries_;
};

}  // namespace

bool is_tiff(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes).substr(0, 4);
  return text == std::string_view("II*\0", 4) || text == std::string_view("MM\0*", 4) ||
         text == std::string_view("II+\0", 4) || text == std::string_view("MM\0+", 4);
}

DatasetFileResult open_tiff_datasets(const VolumeFile& file) {
  ArrayFileResult opened = open_with_module("TIFF", file.content, 0);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  auto pages = std::get<std::shared_ptr<ArrayFile>>(std::move(opened));
  std::size_t missing = 0;
  std::vector<TiffImage> images = tiff_images(*pages, file.name, missing);
  if (images.empty()) return std::string("no image");
  auto planes = std::make_shared<TiffPlanes>(std::move(pages), std::move(images));
  return std::make_unique<TiffDatasets>(std::move(planes), file, missing);
}

}  // namespace gs::app
