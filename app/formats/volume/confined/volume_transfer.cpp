#include "app/formats/volume/confined/volume_transfer.h"

#include "app/formats/common/transfer.h"
#include "qnv/container/step_table.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

enum class ReplyTag : std::uint8_t { error, volume };

void write_layout(TransferWriter& to, const qnv::VolumeLayout& layout) {
  to.value(layout.dimensions);
  for (const glm::vec3& axis : layout.axes) to.value(axis);
  to.value(layout.origin);
  to.value(layout.base);
  to.value(layout.type);
  to.value(std::array{layout.slope, layout.intercept, layout.missing.value_or(0)});
  to.value(std::array<std::uint8_t, 4>{layout.big_endian, layout.missing.has_value(), layout.labels, layout.colors});
  to.value<std::uint64_t>(layout.metadata.size());
  for (const auto& [key, value] : layout.metadata) {
    to.text(key);
    to.text(value);
  }
}

qnv::VolumeLayout read_layout(TransferReader& from) {
  qnv::VolumeLayout layout;
  layout.dimensions = from.value<std::array<std::uint32_t, 3>>();
  for (glm::vec3& axis : layout.axes) axis = from.value<glm::vec3>();
  layout.origin = from.value<glm::dvec3>();
  layout.base = from.value<glm::dvec3>();
  const auto type = from.value<std::uint8_t>();
  require_possible(type <= static_cast<std::uint8_t>(qnv::VoxelType::f64));
  layout.type = static_cast<qnv::VoxelType>(type);
  const auto numbers = from.value<std::array<double, 3>>();
  layout.slope = numbers[0];
  layout.intercept = numbers[1];
  const auto truths = from.value<std::array<std::uint8_t, 4>>();
  layout.big_endian = truths[0] != 0;
  if (truths[1] != 0) layout.missing = numbers[2];
  layout.labels = truths[2] != 0;
  layout.colors = truths[3] != 0;
  constexpr std::size_t kLeastPair = 16;  // bytes
  for (std::size_t left = from.count(kLeastPair); left > 0; --left) {
    std::string key = from.text();
    layout.metadata.emplace_back(std::move(key), from.text());
  }
  require_possible(!qnv::check(layout));
  return layout;
}

// Writes the layout of a source, and how its boxes are read.
void write_plain(TransferWriter& to, const qnv::VolumeSource& source) {
  write_layout(to, source.layout);
  to.value<std::uint8_t>(source.read_box != nullptr);
  to.value(source.chunk);
}

// Writes a source with its components and, if it is a time series, its steps.
void write_source(TransferWriter& to, const qnv::VolumeSource& source) {
  write_plain(to, source);
  to.value<std::uint64_t>(source.components.size());
  for (const qnv::VolumeSource& one : source.components) write_plain(to, one);
}

/// Reader of the sources of a volume.
class SourceReader {
 public:
  SourceReader(TransferReader& from, const MakeSliceReader& make, const MakeBoxReader& make_box)
      : from_(from), make_(make), make_box_(make_box) {}

  qnv::VolumeSource volume() {
    constexpr std::size_t kLeastSource = 100;  // bytes
    qnv::VolumeSource volume = source();
    const std::size_t steps = from_.count(kLeastSource);
    require_possible(steps != 1 && steps <= qnv::kMaxSteps);
    for (std::size_t i = 0; i < steps; ++i) {
      volume.steps.push_back(source());
      const qnv::VolumeSource& step = volume.steps.back();
      require_possible(step.layout.dimensions == volume.layout.dimensions &&
                       step.components.size() == volume.components.size());
    }
    volume.times = from_.list<double>();
    require_possible(volume.times.size() == steps && std::ranges::all_of(volume.times, is_finite) &&
                     std::ranges::is_sorted(volume.times));
    for (std::size_t left = from_.count(kLeastSource); left > 0; --left) {
      volume.coarser.push_back(source());
      const qnv::VolumeSource& one = volume.coarser.back();
      require_possible(one.components.size() == volume.components.size() &&
                       qnv::voxel_count(one.layout) <= qnv::voxel_count(volume.layout));
    }
    return volume;
  }

 private:
  static bool is_finite(double value) { return std::isfinite(value); }

  qnv::VolumeSource plain() {
    qnv::VolumeSource made;
    made.layout = read_layout(from_);
    made.read = make_(number_, made.layout);
    const bool boxes = from_.truth();
    if (boxes && make_box_) made.read_box = make_box_(number_);
    made.chunk = from_.value<std::array<std::uint32_t, 3>>();
    for (std::size_t a = 0; a < 3; ++a) require_possible(made.chunk[a] <= made.layout.dimensions[a]);
    ++number_;
    return made;
  }
  qnv::VolumeSource source() {
    constexpr std::size_t kLeastLayout = 100;  // bytes
    qnv::VolumeSource made = plain();
    const std::size_t components = from_.count(kLeastLayout);
    require_possible(components != 1 && components <= qnv::kMaxValueComponents);
    for (std::size_t i = 0; i < components; ++i) {
      made.components.push_back(plain());
      const qnv::VolumeLayout& one = made.components.back().layout;
      require_possible(one.dimensions == made.layout.dimensions &&
                       (!made.layout.colors || one.type == qnv::VoxelType::u8));
    }
    require_possible(!made.layout.colors || components == 3 || components == 4);
    return made;
  }

  TransferReader& from_;
  const MakeSliceReader& make_;
  const MakeBoxReader& make_box_;
  std::size_t number_ = 0;
};

}  // namespace

std::vector<std::byte> transfer_bytes(const VolumeRequest& request) {
  TransferWriter to;
  to.text(request.path);
  to.text(request.name);
  to.value(request.raw.dimensions);
  to.value(request.raw.type);
  to.value<std::uint8_t>(request.raw.big_endian);
  to.value(request.raw.offset);
  to.value(request.raw.spacing);
  write_component(to, request.component);
  to.value(request.left);
  to.value<std::uint8_t>(request.lists);
  to.value<std::uint8_t>(request.by_parts);
  return to.take();
}

std::optional<VolumeRequest> volume_request_of(std::span<const std::byte> bytes) try {
  TransferReader from(bytes);
  VolumeRequest request;
  request.path = from.text();
  request.name = from.text();
  request.raw.dimensions = from.value<std::array<std::uint32_t, 3>>();
  const auto type = from.value<std::uint8_t>();
  require_possible(type <= static_cast<std::uint8_t>(qnv::VoxelType::f64));
  request.raw.type = static_cast<qnv::VoxelType>(type);
  request.raw.big_endian = from.truth();
  request.raw.offset = from.value<std::uint64_t>();
  request.raw.spacing = from.value<std::array<float, 3>>();
  request.component = read_component(from);
  request.left = from.value<BudgetLeft>();
  request.lists = from.truth();
  request.by_parts = from.truth();
  return request;
} catch (const Impossible&) {
  return std::nullopt;
}

std::vector<std::byte> transfer_bytes(const VolumeReply& reply) {
  TransferWriter to;
  to.value(reply.held);
  if (const auto* const error = std::get_if<std::string>(&reply.volume)) {
    to.value(ReplyTag::error);
    to.text(*error);
    write_datasets(to, reply.datasets);
    return to.take();
  }
  const auto& volume = std::get<qnv::VolumeSource>(reply.volume);
  to.value(ReplyTag::volume);
  write_source(to, volume);
  to.value<std::uint64_t>(volume.steps.size());
  for (const qnv::VolumeSource& step : volume.steps) write_source(to, step);
  to.list(volume.times);
  to.value<std::uint64_t>(volume.coarser.size());
  for (const qnv::VolumeSource& one : volume.coarser) write_source(to, one);
  write_datasets(to, reply.datasets);
  return to.take();
}

std::vector<const qnv::VolumeSource*> numbered_sources(const qnv::VolumeSource& volume) {
  std::vector<const qnv::VolumeSource*> all;
  const auto add = [&all](const qnv::VolumeSource& source) {
    all.push_back(&source);
    for (const qnv::VolumeSource& one : source.components) all.push_back(&one);
  };
  add(volume);
  for (const qnv::VolumeSource& step : volume.steps) add(step);
  for (const qnv::VolumeSource& one : volume.coarser) add(one);
  return all;
}

std::array<std::uint32_t, 9> numbers_of(const qnv::VoxelBox& box) {
  return {box.first[0], box.first[1], box.first[2], box.size[0], box.size[1],
          box.size[2],  box.step[0],  box.step[1],  box.step[2]};
}

qnv::VoxelBox voxel_box_of(const std::array<std::uint32_t, 9>& numbers) {
  return {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}, {numbers[6], numbers[7], numbers[8]}};
}

std::optional<VolumeReply> volume_reply_of(std::span<const std::byte> bytes, const MakeSliceReader& make,
                                           const MakeBoxReader& make_box) try {
  TransferReader from(bytes);
  VolumeReply reply;
  reply.held = from.value<std::uint64_t>();
  const auto tag = from.value<std::uint8_t>();
  require_possible(tag <= static_cast<std::uint8_t>(ReplyTag::volume));
  if (static_cast<ReplyTag>(tag) == ReplyTag::error) {
    std::string error = from.text();
    require_possible(!error.empty());
    reply.volume = std::move(error);
  } else {
    reply.volume = SourceReader(from, make, make_box).volume();
  }
  reply.datasets = read_datasets(from);
  require_possible(from.empty());
  return reply;
} catch (const Impossible&) {
  return std::nullopt;
}

}  // namespace gs::app
